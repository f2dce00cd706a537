//! Why a run cannot be begun, resumed, finished or verified.

use std::io;
use std::path::{Path, PathBuf};

use super::way_on::{has_checkpoint, way_on};
use crate::disk;
use crate::record::RecordError;
use crate::trial::{CheckpointError, PlanError};
use crate::world::WorldError;

/// Why a run cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// Its folder cannot be used.
    #[error(transparent)]
    Folder(#[from] RunFolderError),
    /// Its settings or its world are refused.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The world is no good.
    #[error(transparent)]
    World(#[from] WorldError),
    /// It cannot be recorded, or a recording cannot be read.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A recording does not say where it comes from.
    #[error("{}: {fault}", .file.display())]
    Recording {
        /// The recording.
        file: PathBuf,
        /// What is wrong with it.
        fault: String,
    },
    /// A recording shows two runs where one is asked for.
    #[error(
        "{} is a comparison of two runs; give the folder of one of them, or a recording of it",
        .0.display()
    )]
    TwoRuns(PathBuf),
    /// An evaluation was asked to end before its last episode.
    #[error("interrupted")]
    Stopped,
    /// Highlights draw every cell, and the maze has too many.
    #[error(
        "{world} has too many cells for a highlights recording, which draws each of them; watch single episodes instead"
    )]
    NoHighlights {
        /// The name of the maze.
        world: String,
    },
    /// There is no temporary folder.
    #[error("cannot make a temporary folder: {0}")]
    Temporary(io::Error),
    /// It was asked to stop, and left a checkpoint.
    #[error("interrupted after episode {done} of {all}; {}", way_on(.folder))]
    Interrupted {
        /// Its folder.
        folder: PathBuf,
        /// Finished episodes.
        done: u32,
        /// All episodes.
        all: u32,
    },
    /// It failed, but can be resumed from its last checkpoint.
    #[error("{cause}; {}", way_on(.folder))]
    Resumable {
        /// Its folder.
        folder: PathBuf,
        /// What went wrong.
        cause: Box<RunError>,
    },
}

impl RunError {
    /// The same for a run that has a checkpoint in `folder`.
    pub(super) fn resumable_in(self, folder: &Path) -> Self {
        match self {
            Self::Interrupted { .. } => self,
            // Where the folder is gone, there is nothing to resume.
            cause if !has_checkpoint(folder) => cause,
            cause => Self::Resumable {
                folder: folder.to_owned(),
                cause: Box::new(cause),
            },
        }
    }
}

/// Why a run folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RunFolderError {
    /// There is a run already, or something else.
    #[error(
        "{0} exists: choose another folder with `--out`, or replace the run in it with `--force`"
    )]
    Exists(PathBuf),
    /// There is something that is no run.
    #[error(
        "{0} holds files that no run wrote, and is left as it is, even with `--force`: choose another folder with `--out`"
    )]
    Foreign(PathBuf),
    /// There is a run that did not end.
    #[error("{0} holds an interrupted run: resume it with `xcscr train --resume {path}`, or replace it with `--force`", path = disk::typed(.0))]
    Interrupted(PathBuf),
    /// Another process works in the folder.
    #[error("{folder} is in use by {}: wait for it, or choose another folder with `--out`", holder(.pid))]
    InUse {
        /// The folder.
        folder: PathBuf,
        /// The process, if it could be found out.
        pid: Option<u32>,
    },
    /// There is nothing to resume.
    #[error("{0} holds no interrupted run: begin one with `xcscr train WORLD --out {path}`; `--force` replaces a run that is there", path = disk::typed(.0))]
    NothingToResume(PathBuf),
    /// The checkpoint is of no use.
    #[error("cannot resume from {path}: {fault}")]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        fault: CheckpointError,
    },
    /// The settings or the world are not those that the run began with.
    #[error(
        "{0} was changed since the run began, and a resumed run keeps its settings and world: remove the file to resume as the run began, or begin a new run"
    )]
    Changed(PathBuf),
    /// A file has a name that the run will write, and was not written by one.
    #[error("{0} is not a file of this run, and resuming would replace it: move it away first")]
    InTheWay(PathBuf),
    /// A file of the run is missing.
    #[error("{0} is missing: is {parent} the folder of a finished run?", parent = .0.parent().unwrap_or(.0).display())]
    Missing(PathBuf),
    /// A file of the run holds something else.
    #[error("{path} is damaged: {fault}")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        fault: String,
    },
    /// The world of the run is no good.
    #[error(transparent)]
    World(#[from] WorldError),
    /// A file or folder cannot be made.
    #[error("cannot create {path}: {cause}{}", disk::way_out_or(.cause, "; free this folder, or choose another one with `--out`"))]
    Create {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// A file cannot be read.
    #[error("cannot read {path}: {cause}")]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// A file cannot be written, as on a full disk. Earlier files are whole.
    #[error("cannot write {path}: {cause}{}", disk::way_out(.cause))]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
}

fn holder(pid: &Option<u32>) -> String {
    pid.map_or("another process".to_owned(), |pid| format!("process {pid}"))
}
