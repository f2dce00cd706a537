//! What can be wrong with the folder of a run.

use std::io;
use std::path::PathBuf;

use crate::disk;
use crate::trial::CheckpointError;
use crate::world::WorldError;

/// Why a run folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RunFolderError {
    /// There is a run already, or something else.
    #[error(
        "{0} exists: choose another folder with `--out`, or replace the run in it with `--force`"
    )]
    Exists(PathBuf),
    /// There is something that is no run.
    #[error("{0} holds files, but no run: choose another folder with `--out`")]
    Foreign(PathBuf),
    /// There is a run that did not end.
    #[error("{0} holds an interrupted run: go on with `xcscr train --resume {path}`, or replace it with `--force`", path = disk::typed(.0))]
    Interrupted(PathBuf),
    /// Another process works in the folder.
    #[error("{folder} is in use by {}: wait for it, or choose another folder with `--out`", holder(.pid))]
    InUse {
        /// The folder.
        folder: PathBuf,
        /// The process, if it could be found out.
        pid: Option<u32>,
    },
    /// There is nothing to go on with.
    #[error("{0} holds no interrupted run: begin one with `xcscr train WORLD --out {path}`; `--force` replaces a run that is there", path = disk::typed(.0))]
    NothingToResume(PathBuf),
    /// The checkpoint is of no use.
    #[error("cannot go on from {path}: {fault}")]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        fault: CheckpointError,
    },
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
    #[error("cannot create {path}: {cause}; free this folder, or choose another one with `--out`")]
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
    #[error("cannot write {path}: {cause}; free some space; everything before is kept")]
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
