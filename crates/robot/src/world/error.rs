//! Errors in world files, with their location in the file.

use std::fmt;
use std::io;
use std::path::PathBuf;

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
    /// The file was read, but does not describe a valid world.
    #[error("{0}")]
    Invalid(Box<Diagnostic>),
}

fn did_you_mean(near: &[PathBuf]) -> String {
    let names: Vec<String> = near.iter().map(|path| path.display().to_string()).collect();
    match names.is_empty() {
        true => String::new(),
        false => format!("; did you mean {}?", names.join(" or ")),
    }
}

/// An error in a text: where, what is wrong, and how to fix it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    pub(super) origin: String,
    /// Line and column, counted from 1, the column in characters. `None` for the whole text.
    pub(super) position: Option<(usize, usize)>,
    pub(super) title: String,
    pub(super) help: String,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            origin,
            title,
            help,
            ..
        } = self;
        match self.position {
            Some((line, column)) => write!(f, "{origin}:{line}:{column}: {title}; {help}"),
            None => write!(f, "{origin}: {title}; {help}"),
        }
    }
}
