//! Paths in messages and documents.

use std::path::Path;

/// Formats a path so that it can be pasted into a shell. The path is quoted if necessary and never
/// starts with `-`. Paths that are not UTF-8 or contain control characters use `$'...'`, which
/// bash, ksh and zsh read.
pub fn typed(path: &Path) -> String {
    let path = if path.as_os_str().as_encoded_bytes().starts_with(b"-") {
        &Path::new(".").join(path)
    } else {
        path
    };
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./+:,@%=".contains(c);
    match path
        .to_str()
        .filter(|text| !text.contains(char::is_control))
    {
        Some(text) if !text.is_empty() && text.chars().all(is_plain) => text.to_owned(),
        Some(text) => format!("'{}'", text.replace('\'', r"'\''")),
        None => {
            let bytes = path.as_os_str().as_encoded_bytes().iter();
            let shown = bytes.map(|&byte| match byte {
                b'\'' | b'\\' => format!("\\{}", char::from(byte)),
                b' '..=b'~' => char::from(byte).to_string(),
                _ => format!("\\x{byte:02x}"),
            });
            format!("$'{}'", shown.collect::<String>())
        }
    }
}

/// Formats a path for a document: unchanged if it is UTF-8, otherwise as [`typed`] does.
pub fn named(path: &Path) -> String {
    path.to_str().map_or_else(|| typed(path), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_quoted_for_a_shell() {
        for (path, shown) in [
            ("runs/maze4-s1", "runs/maze4-s1"),
            ("my run", "'my run'"),
            ("-x", "./-x"),
            ("it's", r"'it'\''s'"),
            ("$HOME", "'$HOME'"),
            ("a\u{1b}[2J'\\", r"$'a\x1b[2J\'\\'"),
        ] {
            assert_eq!(typed(Path::new(path)), shown);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_path_that_is_not_utf8_is_quoted_for_a_shell() {
        use std::ffi::OsStr;
        use std::os::unix::ffi::OsStrExt;
        use std::process::Command;
        let path = Path::new(OsStr::from_bytes(b"run \xff\xc3'1"));
        assert_eq!(named(path), r"$'run \xff\xc3\'1'");
        let script = format!("printf %s {}", typed(path));
        let bash = Command::new("bash").args(["-c", &script]).output();
        // bash may not be installed.
        if let Ok(read) = bash {
            assert_eq!(read.stdout, path.as_os_str().as_bytes());
        }
    }
}
