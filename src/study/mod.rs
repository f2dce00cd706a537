//! Studies: trials, their statistics and their reports.

mod analysis;
mod cluster;
mod episodes;
mod error;
mod own;
mod protocol;
mod report;
mod robustness;
mod runner;
mod statistics;
mod store;
mod tuning;

pub use cluster::{Queued, Slurm, TaskProgress, TaskState};
pub use error::StudyError;
pub use own::Study;
pub use protocol::{Arm, Overrides, Protocol, StudyFile, StudyKey, Variant};
pub use report::Report;
pub use robustness::{ConditionResult, LeftOut, Robustness};
pub use runner::StudyWatcher;
pub use statistics::Interval;
pub use store::{Figures, PlannedStudy, Shard, StudyFolder, TrialRecord};
pub use tuning::{Found, Rung, Stage, Standing, Tuning, Verdict};
