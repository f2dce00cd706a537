//! A place in a text, as messages show it.

use std::ops::Range;

/// A place in a text, with the line around it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Counted from 1.
    pub line: usize,
    /// Counted from 1, in characters.
    pub column: usize,
    /// The line, or what is near the place when the line is long.
    pub excerpt: String,
    /// Is the line so long that its beginning is missing?
    pub is_cut: bool,
    /// The place within the excerpt, in bytes.
    pub span: Range<usize>,
    pub label: String,
}

impl Place {
    /// The same without anything that commands a terminal: with colours, a message is printed as
    /// it is.
    pub fn shown(self) -> Self {
        let (before, rest) = self.excerpt.split_at(self.span.start);
        let (within, after) = rest.split_at(self.span.len());
        // Those of ASCII are shown by who draws excerpts.
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

    /// Can one excerpt show both places?
    pub fn shares_line_with(&self, other: &Self) -> bool {
        self.line == other.line && self.excerpt == other.excerpt
    }
}

/// A text with its control characters, but for ends of lines and tabulators, as Rust spells them.
pub fn shown(text: &str) -> String {
    escaped(text, |letter| {
        letter.is_control() && letter != '\n' && letter != '\t'
    })
}

/// A text in which some letters are spelt as Rust does.
fn escaped(text: &str, which: impl Fn(char) -> bool) -> String {
    let show = |letter: char| match which(letter) {
        true => letter.escape_default().to_string(),
        false => letter.to_string(),
    };
    text.chars().map(show).collect()
}
