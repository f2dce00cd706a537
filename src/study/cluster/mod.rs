//! A study on many machines: its tasks, and the cluster engine that runs them.

mod slurm;
mod task;

pub use slurm::{Queued, Slurm};
pub use task::{TaskProgress, TaskState};
