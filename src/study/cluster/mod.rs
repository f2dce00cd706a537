//! A study on many machines: its plan, its tasks, and the cluster engine that runs them.
//!
//! Only two properties of the file system are required. The writes of a process become visible
//! eventually, and in order. Only one process can create a file of a given name. There are no
//! locks, no file is renamed, and no file has two writers: every attempt at a task has its own
//! journal. An attempt repeats trials whose results are not visible yet, and gets the same results.

mod planned;
mod slurm;
mod survey;
mod task;

pub use planned::PlannedStudy;
pub use slurm::{Queued, Slurm, TaskState};
pub use survey::{Survey, TaskSurvey};
