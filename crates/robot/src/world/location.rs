//! A location in a text, as messages show it.

use std::ops::Range;

/// A location in a text, with the line around it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// The line, counted from 1.
    pub line: usize,
    /// The column in characters, counted from 1.
    pub column: usize,
    /// The line, or the part near the location if the line is long.
    pub excerpt: String,
    /// True if the beginning of a long line is cut off.
    pub is_cut: bool,
    /// The location within the excerpt, in bytes.
    pub span: Range<usize>,
    pub label: String,
}

impl Location {
    /// Escapes everything that could control a terminal, because messages with colours are printed
    /// verbatim.
    pub fn shown(self) -> Self {
        let (before, rest) = self.excerpt.split_at(self.span.start);
        let (within, after) = rest.split_at(self.span.len());
        // The renderer of excerpts escapes the ASCII ones.
        let is_upper = |letter: char| letter.is_control() && !letter.is_ascii();
        let show = |text: &str| escaped(text, is_upper);
        let [before, within, after] = [before, within, after].map(show);
        Self {
            span: before.len()..before.len() + within.len(),
            excerpt: before + &within + &after,
            label: shown(&self.label),
            ..self
        }
    }

    /// Returns true if one excerpt can show both locations.
    pub fn shares_line_with(&self, other: &Self) -> bool {
        self.line == other.line && self.excerpt == other.excerpt
    }
}

/// Escapes the control characters of a text in Rust syntax, except line ends and tabs.
pub fn shown(text: &str) -> String {
    escaped(text, |letter| {
        letter.is_control() && letter != '\n' && letter != '\t'
    })
}

/// Escapes the selected characters of a text in Rust syntax.
fn escaped(text: &str, which: impl Fn(char) -> bool) -> String {
    let show = |letter: char| match which(letter) {
        true => letter.escape_default().to_string(),
        false => letter.to_string(),
    };
    text.chars().map(show).collect()
}
