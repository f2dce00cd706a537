//! Errors when starting, resuming, finishing or verifying a run.

use std::fmt::Display;
use std::io;
use std::path::Path;

use crate::record::resume_hint::{is_resumable, resume_hint};
use crate::{Error, ErrorKind};

/// Returns the error that a temporary folder cannot be used.
pub(super) fn temporary(cause: io::Error) -> Error {
    let message = format!("cannot make a temporary folder: {cause}");
    ErrorKind::CannotCreate.error(message)
}

/// Returns the error for a recording that does not contain valid facts of its run, or not the
/// required ones.
pub(super) fn recording(file: &Path, fault: impl Display) -> Error {
    let message = format!("{}: {fault}", file.display());
    ErrorKind::BadData.error(message)
}

/// Returns the error for a folder that contains files that are not those of a run.
pub(super) fn foreign(folder: &Path) -> Error {
    let message = format!(
        "{} contains files that xcscr did not create; refusing to overwrite it, even with `--force`: \
         choose another folder with `--out`",
        folder.display()
    );
    ErrorKind::CannotCreate.error(message)
}

/// Returns the error for a folder that already contains a run.
pub(super) fn exists(folder: &Path) -> Error {
    let message = format!(
        "{} exists: choose another folder with `--out`, or replace the run in it with `--force`",
        folder.display()
    );
    ErrorKind::CannotCreate.error(message)
}

/// Adds how to resume the run in `folder`. A stopped run already says it.
pub(super) fn resumable_in(error: Error, folder: &Path) -> Error {
    if error.kind() != ErrorKind::Interrupted && is_resumable(folder) {
        error.with_hint(&resume_hint(folder))
    } else {
        error
    }
}
