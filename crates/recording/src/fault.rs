//! Errors of recordings. Every message names the file and says what to do. Functions without a cause
//! return the conversion of a cause, for `map_err`.

use std::fmt::Display;
use std::io;
use std::path::Path;

use mcap::McapError;

use crate::disk;
use crate::error::{Error, ErrorKind, world_for_run};

/// The end of the message about a damaged recording.
const ADVICE: &str =
    "; `xcscr recording check` lists the faults, `mcap recover` saves the readable part: ";

/// Returns the conversion of an error when reading a recording.
pub(super) fn cannot_read(path: &Path) -> impl Fn(io::Error) -> Error {
    move |cause| world_for_run(path).unwrap_or_else(|| disk::cannot_read(path)(cause))
}

/// Returns the conversion of an error when writing a file, for example because the disk is full.
/// The data written so far is kept.
pub fn cannot_write<E: Into<McapError>>(path: &Path) -> impl Fn(E) -> Error {
    move |cause| write_failed(path, explained(&cause.into()))
}

/// Returns the error for a file that cannot be written.
pub fn write_failed(path: &Path, cause: impl Display) -> Error {
    let message = format!("cannot write the recording: {cause}: {}", path.display());
    ErrorKind::Io.error(message)
}

/// Returns the conversion of an error when a complete file is compared with what a repeated run
/// records.
pub(super) fn unlike_repeated_run<E: Into<McapError>>(path: &Path) -> impl Fn(E) -> Error {
    move |cause| {
        let message = format!(
            "{} is not what the repeated run records: {}; it was changed, or another version of xcscr wrote \
             it; remove it, or begin a new run with `--force`",
            path.display(),
            explained(&cause.into())
        );
        ErrorKind::BadData.error(message)
    }
}

/// Returns the error for a file with these bytes, which are not an MCAP file.
pub fn not_a_recording(path: &Path, bytes: &[u8]) -> Error {
    let kind = if bytes.starts_with(b"SQLite format 3") {
        "it is a database; `ros2 bag convert` converts a bag to MCAP"
    } else {
        "it does not begin like an MCAP file"
    };
    let message = format!("this is not a recording: {kind}: {}", path.display());
    ErrorKind::BadData.error(message)
}

/// Returns the error for a recording that cannot be used in this way.
pub fn unusable(path: &Path, cause: &str) -> Error {
    let message = format!("{}: {cause}", path.display());
    ErrorKind::BadData.error(message)
}

/// Returns the conversion of a fault in a file.
pub fn damaged<E: Display>(path: &Path) -> impl Fn(E) -> Error {
    move |cause| {
        let message = format!(
            "this recording is damaged: {cause}{ADVICE}{}",
            path.display()
        );
        ErrorKind::BadData.error(message)
    }
}

/// Returns the message of an error without the advice to check the recording.
pub(super) fn without_advice(error: &Error) -> String {
    let message = error.to_string();
    let fault = message
        .split_once(ADVICE)
        .map(|(fault, _)| fault.to_owned());
    fault.unwrap_or(message)
}

/// Returns an error of the library as text. Its own text does not contain the system's error.
pub(super) fn explained(error: &McapError) -> String {
    match error {
        McapError::Io(cause) => format!("{cause}{}", disk::way_out_of_writing(cause)),
        other => other.to_string(),
    }
}
