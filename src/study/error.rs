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
    /// The study file does not exist.
    #[error("unknown study \"{}\": pass a TOML file or one of: {shipped}", .file.display())]
    Missing {
        /// The file.
        file: PathBuf,
        /// The names of the studies that are shipped with the program.
        shipped: String,
    },
    /// The folder contains no study.
    #[error("{} contains no study: it has no plan.json", .0.display())]
    NoStudy(PathBuf),
    /// The folder contains no planned study.
    #[error("{} contains no planned study: it has no tasks.json; create one with `xcscr study plan STUDY --tasks N --out DIR`", .0.display())]
    NotPlanned(PathBuf),
    /// The number of tasks is missing for a new planned study.
    #[error("{} is new: give the number of tasks, such as `--tasks 100`", .0.display())]
    NoTasks(PathBuf),
    /// The study is split into another number of tasks.
    #[error("{} is split into {found} tasks, not {wanted}: leave out `--tasks`, or choose another folder with `--out`", .folder.display())]
    OtherTasks {
        /// The folder.
        folder: PathBuf,
        /// The number of tasks in the folder.
        found: usize,
        /// The number of tasks that was requested.
        wanted: usize,
    },
    /// The study has no task of this number.
    #[error("{} has no task {task}: give a number from 1 to {count}", .folder.display())]
    NoTask {
        /// The folder.
        folder: PathBuf,
        /// The task.
        task: usize,
        /// The number of tasks.
        count: usize,
    },
    /// Another version of this program made the plan.
    #[error("{} was planned by xcscr {found}, but this is {}: use that version, or plan the study again in another folder", .folder.display(), env!("CARGO_PKG_VERSION"))]
    OtherVersion {
        /// The folder.
        folder: PathBuf,
        /// The version that made the plan.
        found: String,
    },
    /// A command of the cluster engine failed.
    #[error("{command}: {fault}")]
    Engine {
        /// The command.
        command: String,
        /// The engine's message, and a hint.
        fault: String,
    },
    /// Invalid study file.
    #[error("{origin}: {fault}")]
    File {
        /// The file.
        origin: String,
        /// The fault.
        fault: String,
    },
    /// Invalid setting.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// Invalid world.
    #[error(transparent)]
    World(#[from] WorldError),
    /// Invalid number in the study.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The folder contains files that are not a study of the required kind.
    #[error("{} contains {holds}; refusing to change it: choose another folder with `--out`", .folder.display())]
    Foreign {
        /// The folder.
        folder: PathBuf,
        /// What the folder contains.
        holds: &'static str,
    },
    /// A file exists, and its contents differ from what would be written.
    #[error("{} exists and differs from what this study would write: replace it with `--force`; the trials are kept", .0.display())]
    Exists(PathBuf),
    /// A generated file was changed by hand.
    #[error("{} was changed after xcscr wrote it: move it away, then run the same command again", .0.display())]
    Altered(PathBuf),
    /// The folder contains another study.
    #[error(
        "{} contains another study (plan {found}, but this one is {wanted}): choose another folder with `--out`, or replace that study with `study run --force`",
        .folder.display()
    )]
    OtherStudy {
        /// The folder.
        folder: PathBuf,
        /// The plan in the folder.
        found: String,
        /// The requested plan.
        wanted: String,
    },
    /// Another process uses the folder.
    #[error("{} is in use by {holder}: wait for it, or choose another folder with `--out`", .folder.display())]
    Locked {
        /// The folder.
        folder: PathBuf,
        /// The process that uses the folder.
        holder: String,
    },
    /// Folders of different studies cannot be merged.
    #[error("{} and {} contain different studies (plans {} and {})", .0.display(), .1.display(), .2, .3)]
    Mixed(PathBuf, PathBuf, String, String),
    /// A trial has two different results.
    #[error("{} contains another result of trial {trial} than {before}: the plan is the same, so the program or the machine may differ", .place.display())]
    Contradiction {
        /// The folder or file with the second result.
        place: PathBuf,
        /// The trial.
        trial: usize,
        /// Where the first result is.
        before: &'static str,
    },
    /// Trials are missing.
    #[error("{missing} of {total} trials are missing; `xcscr study status` lists them")]
    Incomplete {
        /// The number of missing trials.
        missing: usize,
        /// The number of trials.
        total: usize,
    },
    /// A file of the study is damaged.
    #[error("{} is damaged: {fault}", .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The fault.
        fault: String,
    },
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
    /// A figure cannot be drawn.
    #[error("cannot draw {name}: {fault}")]
    Figure {
        /// The figure.
        name: String,
        /// The cause.
        fault: String,
    },
    /// The threads cannot be started.
    #[error(
        "cannot start {jobs} jobs: {fault}; allow more memory and processes, or fewer `--jobs`"
    )]
    Jobs {
        /// The number of threads.
        jobs: usize,
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
    pub(super) fn file(origin: &str, fault: &str) -> Self {
        let (origin, fault) = (origin.to_owned(), fault.to_owned());
        Self::File { origin, fault }
    }

    pub(super) fn io(path: &Path, cause: io::Error) -> Self {
        let path = path.to_owned();
        Self::Io { path, cause }
    }

    pub(super) fn create(path: &Path, cause: io::Error) -> Self {
        let path = path.to_owned();
        Self::Create { path, cause }
    }

    pub(super) fn damaged(path: &Path, fault: impl ToString) -> Self {
        let (path, fault) = (path.to_owned(), fault.to_string());
        Self::Damaged { path, fault }
    }
}
