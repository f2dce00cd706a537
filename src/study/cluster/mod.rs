//! A study on many machines: its tasks.

mod task;

pub use task::{TaskProgress, TaskState};
