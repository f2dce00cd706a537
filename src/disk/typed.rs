//! Paths in messages and documents.

use std::path::Path;

/// A path as it can be typed in a shell: in quotes where it needs them, and never an option. What
/// is no text, or commands a terminal, is written as bash, ksh and zsh read it.
pub fn typed(path: &Path) -> String {
    let path = match path.as_os_str().as_encoded_bytes().starts_with(b"-") {
        true => &Path::new(".").join(path),
        false => path,
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

/// A path in a document: as it is, or as it can be typed where it is no text.
pub fn named(path: &Path) -> String {
    path.to_str().map_or_else(|| typed(path), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_shown_as_it_can_be_typed() {
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
    fn a_path_that_is_no_text_is_shown_as_a_shell_reads_it() {
        use std::ffi::OsStr;
        use std::os::unix::ffi::OsStrExt;
        use std::process::Command;
        let path = Path::new(OsStr::from_bytes(b"run \xff\xc3'1"));
        assert_eq!(named(path), r"$'run \xff\xc3\'1'");
        let script = format!("printf %s {}", typed(path));
        let bash = Command::new("bash").args(["-c", &script]).output();
        // Not every system has this shell.
        if let Ok(read) = bash {
            assert_eq!(read.stdout, path.as_os_str().as_bytes());
        }
    }
}
