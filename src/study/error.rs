//! Why a study cannot be had, run or read.

use std::io;
use std::path::{Path, PathBuf};

use crate::disk;
use crate::trial::{PlanError, SettingsError};
use crate::world::WorldError;

/// Why a study cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// There is no such file.
    #[error("there is no {}: give a study file, or one of {shipped}", .file.display())]
    Missing {
        /// The file.
        file: PathBuf,
        /// The names of the studies that come with the program.
        shipped: String,
    },
    /// The folder holds no study.
    #[error("{} holds no study: there is no plan.json in it", .0.display())]
    NoStudy(PathBuf),
    /// The folder holds no study in tasks.
    #[error("{} holds no planned study: there is no tasks.json in it; make one with `xcscr study plan STUDY --tasks N --out DIR`", .0.display())]
    NotPlanned(PathBuf),
    /// Nobody says into how many tasks a study is to be split.
    #[error("{} is new: say into how many tasks the study is to be split, such as `--tasks 100`", .0.display())]
    NoTasks(PathBuf),
    /// The study is split otherwise.
    #[error("{} is split into {found} tasks, not {wanted}: leave out `--tasks`, or choose another folder with `--out`", .folder.display())]
    OtherTasks {
        /// The folder.
        folder: PathBuf,
        /// Into how many tasks.
        found: usize,
        /// Into how many it was to be.
        wanted: usize,
    },
    /// There is no such task.
    #[error("{} has no task {task}, only 1 to {count}", .folder.display())]
    NoTask {
        /// The folder.
        folder: PathBuf,
        /// The task.
        task: usize,
        /// How many there are.
        count: usize,
    },
    /// Another version of this program made the plan.
    #[error("{} was planned by xcscr {found}, and this is {}: run it with that one, or plan it again in another folder", .folder.display(), env!("CARGO_PKG_VERSION"))]
    OtherVersion {
        /// The folder.
        folder: PathBuf,
        /// The version.
        found: String,
    },
    /// The engine of a cluster does not do what it is asked to.
    #[error("{command}: {fault}")]
    Engine {
        /// What it was asked.
        command: String,
        /// What it says, and the way out.
        fault: String,
    },
    /// The study file describes no study.
    #[error("{origin}: {fault}")]
    File {
        /// The file.
        origin: String,
        /// What is wrong with it.
        fault: String,
    },
    /// A setting is no good.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A world is no good.
    #[error(transparent)]
    World(#[from] WorldError),
    /// A number of the study is no good.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The folder holds something else than a study of the kind that is to come into it.
    #[error("{} holds {holds}, and is left as it is: choose another folder with `--out`", .folder.display())]
    Foreign {
        /// The folder.
        folder: PathBuf,
        /// What is in it.
        holds: &'static str,
    },
    /// A file is there already, and holds something else than would be written.
    #[error("{} exists and holds something other than what this study wrote: replace it with `--force`; the trials are kept", .0.display())]
    Exists(PathBuf),
    /// A file that was made from the study was changed by hand.
    #[error("{} was changed after xcscr wrote it: move it away, then run the same command again", .0.display())]
    Altered(PathBuf),
    /// The folder holds another study.
    #[error(
        "{} holds another study (plan {found}, this one is {wanted}): choose another folder with `--out`, or, with `study run`, replace the study in it with `--force`",
        .folder.display()
    )]
    OtherStudy {
        /// The folder.
        folder: PathBuf,
        /// The plan in the folder.
        found: String,
        /// The plan that was to be run.
        wanted: String,
    },
    /// Another process works in the folder.
    #[error("{} is in use by {holder}: wait for it, or choose another folder with `--out`", .folder.display())]
    Locked {
        /// The folder.
        folder: PathBuf,
        /// Who works in it.
        holder: String,
    },
    /// Folders of different studies cannot be joined.
    #[error("{} and {} hold different studies (plans {} and {})", .0.display(), .1.display(), .2, .3)]
    Mixed(PathBuf, PathBuf, String, String),
    /// There are different results of one trial.
    #[error("{} holds another result of trial {trial} than {before}: same plan, different program or machine?", .place.display())]
    Contradiction {
        /// The folder or file with the second result.
        place: PathBuf,
        /// The trial.
        trial: usize,
        /// Where the first one is.
        before: &'static str,
    },
    /// Trials are missing.
    #[error("{missing} of {total} trials are missing; `xcscr study status` lists them")]
    Incomplete {
        /// How many are missing.
        missing: usize,
        /// How many there are.
        total: usize,
    },
    /// A file of the study holds something else.
    #[error("{} is damaged: {fault}", .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        fault: String,
    },
    /// A folder or file cannot be made.
    #[error("cannot create {}: {cause}{}", .path.display(), disk::way_out_or(.cause, "; choose another folder with `--out`, or free this one"))]
    Create {
        /// The folder or file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// A file cannot be read or written.
    #[error("{}: {cause}{}", .path.display(), way_out(.cause))]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// A picture cannot be drawn.
    #[error("cannot draw {name}: {fault}")]
    Figure {
        /// The figure.
        name: String,
        /// Why.
        fault: String,
    },
    /// The threads cannot be started.
    #[error(
        "cannot start {jobs} jobs: {fault}; allow more memory and processes, or fewer `--jobs`"
    )]
    Jobs {
        /// How many.
        jobs: usize,
        /// Why.
        fault: String,
    },
}

/// What helps when a file cannot be written.
fn way_out(cause: &io::Error) -> String {
    let again = match disk::is_full(cause) {
        true => ", and give the same command again: finished trials are kept",
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
