//! A named text, and the mapping from its parts to line and column.

use super::error::{Diagnostic, WorldError};

/// A text and its name in messages.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    pub origin: &'a str,
    pub text: &'a str,
}

impl Source<'_> {
    /// Returns the first byte of `part`, which must be a slice of this text.
    pub fn start_of(&self, part: &str) -> usize {
        (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize)
    }

    /// Returns the error for the text from byte `at`: what is wrong, and how to fix it.
    pub fn fault(
        &self,
        at: usize,
        title: impl Into<String>,
        help: impl Into<String>,
    ) -> WorldError {
        let boundary = (0..=at.min(self.text.len())).rfind(|&at| self.text.is_char_boundary(at));
        let before = &self.text[..boundary.unwrap_or(0)];
        let line_start = before.rfind('\n').map_or(0, |end| end + 1);
        let line = 1 + before.matches('\n').count();
        let column = 1 + before[line_start..].chars().count();
        Self::error(self.origin, Some((line, column)), title, help)
    }

    /// Returns the error for a whole file.
    pub fn error(
        origin: &str,
        position: Option<(usize, usize)>,
        title: impl Into<String>,
        help: impl Into<String>,
    ) -> WorldError {
        WorldError::Invalid(Box::new(Diagnostic {
            origin: shown(origin),
            position,
            title: shown(&title.into()),
            help: shown(&help.into()),
        }))
    }
}

/// Escapes the control characters of a text in Rust syntax.
fn shown(text: &str) -> String {
    let show = |letter: char| match letter.is_control() {
        true => letter.escape_default().to_string(),
        false => letter.to_string(),
    };
    text.chars().map(show).collect()
}

/// Quotes a text from a file for use in a message: short, without control characters.
pub fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    let shown: String = text.chars().take(LONGEST).map(printable).collect();
    let dots = if text.chars().nth(LONGEST).is_some() {
        "..."
    } else {
        ""
    };
    format!("`{shown}{dots}`")
}

fn printable(letter: char) -> String {
    match letter {
        '\\' | '"' | '\'' => letter.to_string(),
        _ => letter.escape_debug().to_string(),
    }
}
