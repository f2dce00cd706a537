//! What settings files and study files have in common.

/// The largest settings or study file, in bytes: a thousand times what anybody writes, and little
/// enough to be parsed in a moment.
pub const MOST_TOML_BYTES: u64 = 1 << 20;
/// How much of a line is repeated in a message.
const WIDEST: usize = 160;

/// A message that repeats a part of its input, with long lines cut off.
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
