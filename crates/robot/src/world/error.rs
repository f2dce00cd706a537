//! Errors in world files, with their location in the file.

use std::io;
use std::path::PathBuf;

use super::maze::Cell;

/// The longest part of a JSON error that a message has, in characters: it quotes the file.
const LONGEST_CAUSE: usize = 300;

/// The world cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// There is no such file.
    #[error("there is no world file `{}`{}", .path.display(), did_you_mean(.near))]
    Missing {
        /// The requested file.
        path: PathBuf,
        /// Files with similar names.
        near: Vec<PathBuf>,
    },
    /// The file exists, but cannot be read.
    #[error("cannot read the world file `{}`: {source}", .path.display())]
    Unreadable {
        /// The requested file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The file was read, but does not describe a valid world. The message says where, what is wrong, and how to fix it.
    #[error("{0}")]
    Invalid(String),
}

fn did_you_mean(near: &[PathBuf]) -> String {
    let names: Vec<String> = near.iter().map(|path| path.display().to_string()).collect();
    match names.is_empty() {
        true => String::new(),
        false => format!("; did you mean {}?", names.join(" or ")),
    }
}

/// A fault of a world: where, what is wrong, and how to fix it.
#[derive(Debug)]
pub(super) struct Fault {
    /// The end of the place after the name of the file; empty for the whole file.
    place: String,
    title: String,
    help: String,
}

impl Fault {
    /// Creates a fault of the whole world.
    pub fn new(title: impl Into<String>, help: impl Into<String>) -> Self {
        Self {
            place: String::new(),
            title: title.into(),
            help: help.into(),
        }
    }

    /// Creates a fault of a cell; row and column are counted from 1.
    pub fn at_cell(cell: Cell, title: impl Into<String>, help: impl Into<String>) -> Self {
        let [row, column] = [cell.row, cell.col].map(|number| u32::from(number) + 1);
        Self {
            place: format!(": row {row}, column {column}"),
            ..Self::new(title, help)
        }
    }

    /// Creates a fault of the JSON text, at its line and column.
    pub fn at_json(error: &serde_json::Error, help: impl Into<String>) -> Self {
        let (line, column) = (error.line(), error.column());
        let place = format!(" at line {line} column {column}");
        let cause = error.to_string().replace(&place, "");
        let cause: String = cause.chars().take(LONGEST_CAUSE).collect();
        Self {
            place: format!(":{line}:{column}"),
            ..Self::new(cause, help)
        }
    }

    /// Returns the error for a file of this name.
    pub fn in_file(self, origin: &str) -> WorldError {
        let Self { place, title, help } = self;
        WorldError::Invalid(shown(&format!("{origin}{place}: {title}; {help}")))
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

/// Quotes the beginning of a text from a file for use in a message.
pub(super) fn quoted(text: &str) -> String {
    const LONGEST: usize = 40;
    let shown: String = text.chars().take(LONGEST).collect();
    let dots = if text.chars().nth(LONGEST).is_some() {
        "..."
    } else {
        ""
    };
    format!("`{shown}{dots}`")
}
