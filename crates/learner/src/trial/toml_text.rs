//! Common code for settings files and study files.

/// The maximum size of a settings or study file, in bytes: a thousand times a typical size, and
/// small enough to parse quickly.
pub const MOST_TOML_BYTES: u64 = 1 << 20;
/// The maximum length of a line in a message, in characters.
const WIDEST: usize = 160;

/// Returns a message that quotes its input, with long lines cut off.
pub fn shortened(message: &str) -> String {
    let lines: Vec<String> = message.trim_end().lines().map(cut).collect();
    lines.join("\n")
}

fn cut(line: &str) -> String {
    match line.char_indices().nth(WIDEST) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_long_lines_are_cut() {
        let wide = "ü".repeat(WIDEST);
        assert_eq!(shortened(&format!("a\n{wide}\n")), format!("a\n{wide}"));
        assert_eq!(shortened(&format!("{wide}x\nb")), format!("{wide}…\nb"));
    }
}
