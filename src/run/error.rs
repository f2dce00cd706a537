//! Errors when starting, resuming, finishing or verifying a run.

use std::io;
use std::path::{Path, PathBuf};

use super::resume_hint::{has_checkpoint, resume_hint};
use crate::disk;
use crate::record::RecordError;
use crate::trial::{CheckpointError, PlanError};
use crate::world::WorldError;

/// An error of a run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The run's folder cannot be used.
    #[error(transparent)]
    Folder(#[from] RunFolderError),
    /// The settings or the world are invalid.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The world is invalid.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The run cannot be recorded, or a recording cannot be read.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A recording does not contain valid facts of its run.
    #[error("{}: {fault}", .file.display())]
    Recording {
        /// The recording.
        file: PathBuf,
        /// The fault.
        fault: String,
    },
    /// A comparison of two runs was given where one run is required.
    #[error(
        "{} is a comparison of two runs; give the folder of one of them, or a recording of it",
        .0.display()
    )]
    TwoRuns(PathBuf),
    /// An evaluation was stopped before its last episode.
    #[error("interrupted")]
    Stopped,
    /// Highlights draw every cell, and the maze has too many cells.
    #[error(
        "{world} has too many cells for a highlights recording, which draws each of them; watch single episodes instead"
    )]
    NoHighlights {
        /// The name of the maze.
        world: String,
    },
    /// A temporary folder cannot be created.
    #[error("cannot make a temporary folder: {0}")]
    Temporary(io::Error),
    /// The run was stopped and can be resumed from a checkpoint.
    #[error("interrupted after episode {done} of {all}; {}", resume_hint(.folder))]
    Interrupted {
        /// The run's folder.
        folder: PathBuf,
        /// The number of finished episodes.
        done: u32,
        /// The number of all episodes.
        all: u32,
    },
    /// The run failed, but can be resumed from its last checkpoint.
    #[error("{cause}; {}", resume_hint(.folder))]
    Resumable {
        /// The run's folder.
        folder: PathBuf,
        /// The cause.
        cause: Box<RunError>,
    },
}

impl RunError {
    /// Adds how to resume the run, if `folder` has a checkpoint.
    pub(super) fn resumable_in(self, folder: &Path) -> Self {
        match self {
            Self::Interrupted { .. } => self,
            // Without a checkpoint there is nothing to resume.
            cause if !has_checkpoint(folder) => cause,
            cause => Self::Resumable {
                folder: folder.to_owned(),
                cause: Box::new(cause),
            },
        }
    }
}

/// An error that prevents the use of a run folder.
#[derive(Debug, thiserror::Error)]
pub enum RunFolderError {
    /// The folder already contains a run or an evaluation.
    #[error(
        "{0} exists: choose another folder with `--out`, or replace the run in it with `--force`"
    )]
    Exists(PathBuf),
    /// The folder contains files that are not those of a run.
    #[error(
        "{0} contains files that xcscr did not create; refusing to overwrite it, even with `--force`: choose another folder with `--out`"
    )]
    Foreign(PathBuf),
    /// The folder contains an interrupted run.
    #[error("{0} contains an interrupted run: resume it with `xcscr train --resume {path}`, or replace it with `--force`", path = disk::typed(.0))]
    Interrupted(PathBuf),
    /// Another process uses the folder.
    #[error("{folder} is in use by {}: wait for it, or choose another folder with `--out`", holder(.pid))]
    InUse {
        /// The folder.
        folder: PathBuf,
        /// The process, if it is known.
        pid: Option<u32>,
    },
    /// There is nothing to resume.
    #[error("{0} contains no interrupted run: begin one with `xcscr train WORLD --out {path}`; `--force` replaces an existing run", path = disk::typed(.0))]
    NothingToResume(PathBuf),
    /// The checkpoint cannot be used.
    #[error("cannot resume from {path}: {fault}")]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// The fault.
        fault: CheckpointError,
    },
    /// The settings or the world differ from those at the start of the run.
    #[error(
        "{0} was changed since the run began, and a resumed run keeps its settings and world: remove the file to resume as the run began, or begin a new run"
    )]
    Changed(PathBuf),
    /// A file has a name that the run will write, but was not written by a run.
    #[error("{0} is not a file of this run, and resuming would replace it: move it away first")]
    InTheWay(PathBuf),
    /// A file of the run is missing.
    #[error("{0} is missing: is {parent} the folder of a finished run?", parent = .0.parent().unwrap_or(.0).display())]
    Missing(PathBuf),
    /// A file of the run is invalid.
    #[error("{path} is damaged: {fault}")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The fault.
        fault: String,
    },
    /// The world of the run is invalid.
    #[error(transparent)]
    World(#[from] WorldError),
    /// A file or folder cannot be created.
    #[error("cannot create {path}: {cause}{}", disk::way_out_or(.cause, "; free this folder, or choose another one with `--out`"))]
    Create {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        cause: io::Error,
    },
    /// A file cannot be read.
    #[error("cannot read {path}: {cause}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        cause: io::Error,
    },
    /// A file cannot be written, for example because the disk is full. Earlier files are complete.
    #[error("cannot write {path}: {cause}{}", disk::way_out(.cause))]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's error.
        cause: io::Error,
    },
}

fn holder(pid: &Option<u32>) -> String {
    pid.map_or("another process".to_owned(), |pid| format!("process {pid}"))
}

impl RunFolderError {
    /// Returns the conversion of an error when reading a file or folder.
    pub(super) fn io(path: &Path) -> impl Fn(io::Error) -> Self {
        move |cause| Self::Io {
            path: path.to_owned(),
            cause,
        }
    }

    /// Returns the conversion of an error when creating a file or folder.
    pub(super) fn create(path: &Path) -> impl Fn(io::Error) -> Self {
        move |cause| Self::Create {
            path: path.to_owned(),
            cause,
        }
    }

    /// Returns the conversion of an error when writing a file.
    pub(super) fn write(path: &Path) -> impl Fn(io::Error) -> Self {
        move |cause| Self::Write {
            path: path.to_owned(),
            cause,
        }
    }
}
