//! Errors when loading, running or reading a study.

use std::fmt::Display;
use std::io;
use std::path::Path;

use crate::disk;
use crate::{Error, ErrorKind};

/// Returns the error for a fault in the study file `origin`.
pub(super) fn file(origin: &str, fault: impl Display) -> Error {
    ErrorKind::BadData.error(format!("{origin}: {fault}"))
}

/// Returns the conversion of a fault in a plan or journal.
pub(super) fn damaged<E: Display>(path: &Path) -> impl Fn(E) -> Error {
    move |fault| {
        let message = format!("{} is damaged: {fault}", path.display());
        ErrorKind::BadData.error(message)
    }
}

/// Returns the conversion of an error when starting `jobs` threads.
pub(super) fn jobs<E: Display>(jobs: usize) -> impl Fn(E) -> Error {
    move |fault| {
        let message = format!(
            "cannot start {jobs} jobs: {fault}; allow more memory and processes, or fewer `--jobs`"
        );
        ErrorKind::Io.error(message)
    }
}

/// Returns the conversion of an error when reading or writing a file.
pub(super) fn io(path: &Path) -> impl Fn(io::Error) -> Error {
    move |cause| {
        let again = if disk::is_full(&cause) {
            ", then run the same command again: finished trials are kept"
        } else {
            ""
        };
        let (path, hint) = (path.display(), disk::way_out_of_writing(&cause));
        ErrorKind::Io.error(format!("{path}: {cause}{hint}{again}"))
    }
}
