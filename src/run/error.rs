//! Errors when starting, resuming, finishing or verifying a run.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use super::contents::CONFIG;
use crate::disk;
use crate::record::resume_hint::{is_resumable, resume_hint};
use crate::{Error, ErrorKind};

/// The end of the name that the command line gives to the folder of an evaluation by default, after
/// the name of the run.
const EVALUATION: &str = "-evaluation";

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

/// Returns the error for the folder of an evaluation where that of a run is required.
pub(super) fn evaluation(folder: &Path) -> Error {
    let known = evaluated_run(folder).map_or_else(String::new, |run| {
        format!(", such as {}", disk::typed(&run))
    });
    let message = format!(
        "{} contains an evaluation, in which nothing is learned: give the folder of the run whose \
         policy it drives{known}",
        folder.display()
    );
    ErrorKind::BadData.error(message)
}

/// Returns the folder of the evaluated run if it is next to an evaluation with the default name.
fn evaluated_run(folder: &Path) -> Option<PathBuf> {
    let name = folder.file_name()?.to_str()?.strip_suffix(EVALUATION)?;
    let run = folder.with_file_name(name);
    run.join(CONFIG).is_file().then_some(run)
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

/// Returns the error for a folder that already contains a run or an evaluation.
pub(super) fn exists(folder: &Path) -> Error {
    let message = format!(
        "{} exists: choose another folder with `--out`, or replace the run in it with `--force`",
        folder.display()
    );
    ErrorKind::CannotCreate.error(message)
}

/// Adds how to resume the run in `folder`. A stopped run already says it.
pub(super) fn resumable_in(error: Error, folder: &Path) -> Error {
    match error.kind() != ErrorKind::Interrupted && is_resumable(folder) {
        true => error.with_hint(&resume_hint(folder)),
        false => error,
    }
}
