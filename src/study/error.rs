//! Errors when loading, running or reading a study.

use std::io;
use std::path::{Path, PathBuf};

use crate::disk;
use crate::trial::{PlanError, SettingsError};
use crate::world::WorldError;

/// An error of a study.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// Invalid setting.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Invalid world.
    #[error(transparent)]
    World(#[from] WorldError),
    /// Invalid number in the study.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A study or its folder does not exist.
    #[error("{0}")]
    Missing(String),
    /// An argument is missing, or does not fit the study.
    #[error("{0}")]
    Usage(String),
    /// A study file, a plan or a journal is invalid, or two of them contradict each other.
    #[error("{0}")]
    Invalid(String),
    /// Trials are missing.
    #[error("{missing} of {total} trials are missing; `xcscr study status` lists them")]
    Incomplete {
        /// The number of missing trials.
        missing: usize,
        /// The number of trials.
        total: usize,
    },
    /// The folder or a file in it has other contents, which are not replaced.
    #[error("{0}")]
    Refused(String),
    /// Another process uses the folder.
    #[error("{0}")]
    Locked(String),
    /// A folder or file cannot be created.
    #[error("cannot create {}: {cause}{}", .path.display(), disk::way_out_or(.cause, "; choose another folder with `--out`, or free this one"))]
    Create {
        /// The folder or file.
        path: PathBuf,
        /// The cause.
        cause: io::Error,
    },
    /// A file cannot be read or written.
    #[error("{}: {cause}{}", .path.display(), hint(.cause))]
    Io {
        /// The file.
        path: PathBuf,
        /// The cause.
        cause: io::Error,
    },
    /// Threads cannot be started, or a command of the cluster engine failed.
    #[error("{0}")]
    System(String),
    /// A figure cannot be drawn.
    #[error("cannot draw {name}: {fault}")]
    Figure {
        /// The figure.
        name: &'static str,
        /// The cause.
        fault: String,
    },
}

/// Returns a hint for a file that cannot be written.
fn hint(cause: &io::Error) -> String {
    let again = match disk::is_full(cause) {
        true => ", then run the same command again: finished trials are kept",
        false => "",
    };
    format!("{}{again}", disk::way_out(cause))
}

impl StudyError {
    /// Returns the error for a fault in the study file `origin`.
    pub(super) fn file(origin: &str, fault: impl std::fmt::Display) -> Self {
        Self::Invalid(format!("{origin}: {fault}"))
    }

    pub(super) fn damaged(path: &Path, fault: impl std::fmt::Display) -> Self {
        Self::Invalid(format!("{} is damaged: {fault}", path.display()))
    }

    /// Returns the error for a generated file that was changed by hand.
    pub(super) fn altered(path: &Path) -> Self {
        Self::Refused(format!(
            "{} was changed after xcscr wrote it: move it away, then run the same command again",
            path.display()
        ))
    }

    /// Returns the error for `jobs` threads that cannot be started.
    pub(super) fn jobs(jobs: usize, fault: impl std::fmt::Display) -> Self {
        Self::System(format!(
            "cannot start {jobs} jobs: {fault}; allow more memory and processes, or fewer `--jobs`"
        ))
    }

    pub(super) fn io(path: &Path, cause: io::Error) -> Self {
        let path = path.to_owned();
        Self::Io { path, cause }
    }

    pub(super) fn create(path: &Path, cause: io::Error) -> Self {
        let path = path.to_owned();
        Self::Create { path, cause }
    }
}
