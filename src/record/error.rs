//! Errors when writing and reading recordings.

use std::io;
use std::path::{Path, PathBuf};

use mcap::McapError;

use crate::disk;

/// An error when writing or reading a recording.
///
/// Every message names the file and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file could not be created.
    #[error("cannot create the recording: {cause}{}: {}", disk::way_out_or(.cause, "; choose another folder, or free this one"), path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// The system's error.
        cause: io::Error,
    },
    /// Writing stopped part-way, for example because the disk is full. The data written so far is
    /// kept.
    #[error("cannot write the recording: {cause}: {}", path.display())]
    Write {
        /// The file, whose name still ends with `.part`.
        path: PathBuf,
        /// The system's error.
        cause: String,
    },
    /// A recovered recording could not be written. The incomplete output is removed, and the
    /// damaged input file is unchanged.
    #[error("cannot write the recovered recording: {cause}: {}", path.display())]
    Recover {
        /// The output file.
        path: PathBuf,
        /// The system's error.
        cause: String,
    },
    /// The file could not be read from the disk.
    #[error("cannot read the recording: {cause}: {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        cause: io::Error,
    },
    /// The program ended while it was writing the file.
    #[error("this recording was never finished, so viewers cannot open it; recover it with `xcscr recording recover {0} -o OUT.mcap`", path.display())]
    Unfinished {
        /// The file.
        path: PathBuf,
    },
    /// The file is not an MCAP file.
    #[error("this is not a recording: it does not begin like an MCAP file: {}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The MCAP file is damaged.
    #[error("this recording is damaged: {cause}; `xcscr recording check` lists the faults, `xcscr recording recover` saves the readable part: {}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The fault and its position.
        cause: String,
    },
}

impl RecordError {
    /// Returns the conversion of an error when creating a file.
    pub(super) fn create(path: &Path) -> impl Fn(io::Error) -> Self {
        move |cause| Self::Create {
            path: path.to_owned(),
            cause,
        }
    }

    /// Returns the conversion of an error when reading a file.
    pub(super) fn read(path: &Path) -> impl Fn(io::Error) -> Self {
        move |cause| Self::Read {
            path: path.to_owned(),
            cause,
        }
    }

    /// Returns the conversion of an error when writing a file.
    pub(super) fn write(path: &Path) -> impl Fn(McapError) -> Self {
        move |cause| Self::Write {
            path: path.to_owned(),
            cause: explained(&cause),
        }
    }

    /// Returns the conversion of a fault in a file.
    pub(super) fn damaged<E: std::fmt::Display>(path: &Path) -> impl Fn(E) -> Self {
        move |cause| Self::Damaged {
            path: path.to_owned(),
            cause: cause.to_string(),
        }
    }
}

/// Returns an error of the library as text. Its own text does not contain the system's error.
pub(super) fn explained(error: &McapError) -> String {
    match error {
        McapError::Io(cause) => format!("{cause}{}", disk::way_out(cause)),
        other => other.to_string(),
    }
}
