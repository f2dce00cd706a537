//! A study on many machines: its plan, its tasks, and the engine that runs them.
//!
//! Nothing is asked of the file system but that it shows what a process has written, at some time,
//! in the order in which it was written, and that a new name is given to one process only. There
//! are no locks, and no file is renamed or written by two: every attempt at a task has a journal
//! of its own. What an attempt does not see yet it runs again, to the same result.

mod planned;
mod slurm;
mod survey;
mod task;

pub use planned::PlannedStudy;
pub use slurm::{Queued, Slurm, TaskState};
pub use survey::{Survey, TaskSurvey};
