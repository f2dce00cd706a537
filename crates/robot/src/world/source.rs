//! A named text, and the mapping from its parts to line and column.

use std::ops::Range;

use super::error::{Diagnostic, WorldError};
use super::location::{Location, shown};

/// The number of bytes that an excerpt of a long line keeps on either side of a location.
const EXCERPT_BYTES: usize = 8192;

/// A text and its name in messages.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    pub origin: &'a str,
    pub text: &'a str,
}

impl Source<'_> {
    /// Returns the span of `part`, which must be a slice of this text.
    pub fn span(&self, part: &str) -> Range<usize> {
        let start = (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        start..start + part.len()
    }

    /// Returns the location of a span, cut at the end of its first line.
    pub fn location(&self, span: Range<usize>, label: impl Into<String>) -> Location {
        let text = self.text;
        let at = floor(text, span.start);
        let line_start = text[..at].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[at..].find('\n').map_or(text.len(), |i| at + i);
        let line_end = line_start + text[line_start..line_end].trim_end_matches('\r').len();
        let from = floor(text, at.saturating_sub(EXCERPT_BYTES)).max(line_start);
        let to = floor(text, at + EXCERPT_BYTES).min(line_end);
        let at = at.min(to);
        Location {
            line: 1 + text[..line_start].matches('\n').count(),
            column: 1 + text[line_start..at].chars().count(),
            is_cut: from > line_start,
            excerpt: text[from..to].to_owned(),
            span: at - from..floor(text, span.end).clamp(at, to) - from,
            label: label.into(),
        }
    }

    /// Returns the error that points at `span`.
    pub fn fault(
        &self,
        span: Range<usize>,
        title: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> WorldError {
        self.fault_at(vec![self.location(span, label)], title, help)
    }

    /// Returns the error that points at several locations, the fault first, or at the whole text.
    pub fn fault_at(
        &self,
        locations: Vec<Location>,
        title: impl Into<String>,
        help: impl Into<String>,
    ) -> WorldError {
        WorldError::Invalid(Box::new(Diagnostic {
            origin: shown(self.origin),
            title: shown(&title.into()),
            locations: locations.into_iter().map(Location::shown).collect(),
            help: shown(&help.into()),
        }))
    }
}

/// Returns the last character boundary at or before `index`.
fn floor(text: &str, index: usize) -> usize {
    let index = index.min(text.len());
    (0..=index)
        .rev()
        .find(|&i| text.is_char_boundary(i))
        .unwrap_or(0)
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
