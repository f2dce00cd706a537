//! Names of worlds. They become parts of folder names, so they are checked.

/// The longest name, in characters.
const LONGEST: usize = 64;

/// Names that Windows reserves for devices.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];

/// The rule, for messages.
pub const RULE: &str = "a name has 1 to 64 letters (a to z, A to Z), digits, `-`, `_` or `.`, \
     no dot at either end, and is not a device name such as `CON`";

/// Returns true if the text can be part of a folder name on every system.
pub fn is_valid(name: &str) -> bool {
    (1..=LONGEST).contains(&name.len())
        && name.bytes().all(is_name_byte)
        && !name.starts_with('.')
        && !name.ends_with('.')
        && !is_device(name)
}

/// Returns the nearest valid name, for a suggestion.
pub fn repaired(text: &str) -> String {
    let name: String = text
        .chars()
        .map(|c| match u8::try_from(c) {
            Ok(byte) if is_name_byte(byte) => c,
            _ => '-',
        })
        .take(LONGEST)
        .collect();
    let name = name.trim_matches(['.', '-']);
    match is_valid(name) {
        true => name.to_owned(),
        false => "my-maze".to_owned(),
    }
}

fn is_name_byte(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.')
}

/// Returns true for names that Windows treats as devices, for example `con` and `COM1.txt`.
fn is_device(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or(name).to_ascii_lowercase();
    let port = stem
        .strip_prefix("com")
        .or_else(|| stem.strip_prefix("lpt"))
        .is_some_and(|number| matches!(number.as_bytes(), [b'0'..=b'9']));
    port || DEVICES.contains(&stem.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordinary_names_are_valid() {
        for name in [
            "maze4",
            "a",
            "My_maze-2.1",
            "console",
            "com",
            &"x".repeat(64),
        ] {
            assert!(is_valid(name), "{name}");
        }
    }

    #[test]
    fn hostile_names_are_refused_and_repaired() {
        for name in [
            "",
            ".",
            "..",
            "../x",
            "/etc/passwd",
            "a/b",
            "a\\b",
            "C:x",
            "CON",
            "nul.txt",
            "Lpt1",
            "com0.a",
            "a b",
            "a\0b",
            ".hidden",
            "dot.",
            "größe",
            &"x".repeat(65),
        ] {
            assert!(!is_valid(name), "{name:?}");
            assert!(is_valid(&repaired(name)), "{name:?} -> {}", repaired(name));
        }
    }
}
