//! A text with its name: from a part of the text to its line and column.

use std::ops::Range;

use super::error::{Diagnostic, WorldError};
use super::place::{Place, shown};

/// Bytes of a long line that an excerpt keeps on either side of a place.
const EXCERPT_BYTES: usize = 8192;

/// A text and the name that messages call it by.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    pub origin: &'a str,
    pub text: &'a str,
}

impl Source<'_> {
    /// Where `part`, a slice of this text, lies in it.
    pub fn span(&self, part: &str) -> Range<usize> {
        let start = (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        start..start + part.len()
    }

    /// The place of a span, which ends at the end of its first line at the latest.
    pub fn place(&self, span: Range<usize>, label: impl Into<String>) -> Place {
        let text = self.text;
        let at = floor(text, span.start);
        let line_start = text[..at].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[at..].find('\n').map_or(text.len(), |i| at + i);
        let line_end = line_start + text[line_start..line_end].trim_end_matches('\r').len();
        let from = floor(text, at.saturating_sub(EXCERPT_BYTES)).max(line_start);
        let to = floor(text, at + EXCERPT_BYTES).min(line_end);
        let at = at.min(to);
        Place {
            line: 1 + text[..line_start].matches('\n').count(),
            column: 1 + text[line_start..at].chars().count(),
            is_cut: from > line_start,
            excerpt: text[from..to].to_owned(),
            span: at - from..floor(text, span.end).clamp(at, to) - from,
            label: label.into(),
        }
    }

    /// The error that points at `span`.
    pub fn fault(
        &self,
        span: Range<usize>,
        title: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> WorldError {
        self.fault_at(vec![self.place(span, label)], title, help)
    }

    /// The error that points at several places, the culprit first; or at the whole text.
    pub fn fault_at(
        &self,
        places: Vec<Place>,
        title: impl Into<String>,
        help: impl Into<String>,
    ) -> WorldError {
        WorldError::Invalid(Box::new(Diagnostic {
            origin: shown(self.origin),
            title: shown(&title.into()),
            places: places.into_iter().map(Place::shown).collect(),
            help: shown(&help.into()),
        }))
    }
}

/// The last character boundary at or before `index`.
fn floor(text: &str, index: usize) -> usize {
    let index = index.min(text.len());
    (0..=index)
        .rev()
        .find(|&i| text.is_char_boundary(i))
        .unwrap_or(0)
}

/// A text from a file for use in a message: quoted, without control characters, and short.
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
