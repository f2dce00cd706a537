//! Errors when starting, resuming, finishing or verifying a run.

use std::fmt::Display;
use std::io;
use std::path::Path;

use crate::disk;
use crate::error::ErrorKind;
use crate::record::resume_hint::{has_checkpoint, resume_hint};

pub use crate::error::Error as RunError;

/// Returns the conversion of an error when creating a file or folder.
pub(super) fn create(path: &Path) -> impl Fn(io::Error) -> RunError {
    move |cause| {
        let place = "; free this folder, or choose another one with `--out`";
        let hint = disk::way_out_or(&cause, place);
        let message = format!("cannot create {}: {cause}{hint}", path.display());
        ErrorKind::CannotCreate.error(message)
    }
}

/// Returns the conversion of an error when reading a file or folder.
pub(super) fn read(path: &Path) -> impl Fn(io::Error) -> RunError {
    move |cause| {
        let message = format!("cannot read {}: {cause}", path.display());
        ErrorKind::Io.error(message)
    }
}

/// Returns the conversion of an error when writing a file, for example because the disk is full.
/// Earlier files are complete.
pub(super) fn write(path: &Path) -> impl Fn(io::Error) -> RunError {
    move |cause| {
        let (path, hint) = (path.display(), disk::way_out(&cause));
        ErrorKind::Io.error(format!("cannot write {path}: {cause}{hint}"))
    }
}

/// Returns the error that a temporary folder cannot be used.
pub(super) fn temporary(cause: io::Error) -> RunError {
    let message = format!("cannot make a temporary folder: {cause}");
    ErrorKind::CannotCreate.error(message)
}

/// Returns the error for a recording that does not contain valid facts of its run, or not the
/// required ones.
pub(super) fn recording(file: &Path, fault: impl Display) -> RunError {
    let message = format!("{}: {fault}", file.display());
    ErrorKind::BadData.error(message)
}

/// Returns the error for a folder that contains files that are not those of a run.
pub(super) fn foreign(folder: &Path) -> RunError {
    let message = format!(
        "{} contains files that xcscr did not create; refusing to overwrite it, even with `--force`: \
         choose another folder with `--out`",
        folder.display()
    );
    ErrorKind::CannotCreate.error(message)
}

/// Returns the error for a folder that already contains a run or an evaluation.
pub(super) fn exists(folder: &Path) -> RunError {
    let message = format!(
        "{} exists: choose another folder with `--out`, or replace the run in it with `--force`",
        folder.display()
    );
    ErrorKind::CannotCreate.error(message)
}

/// Adds how to resume the run, if `folder` has a checkpoint. A stopped run already says it.
pub(super) fn resumable_in(error: RunError, folder: &Path) -> RunError {
    match error.kind() != ErrorKind::Interrupted && has_checkpoint(folder) {
        true => error.with_hint(&resume_hint(folder)),
        false => error,
    }
}
