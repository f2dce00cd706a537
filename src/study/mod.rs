//! Studies: from many trials to an answer.

mod analysis;
mod error;
mod protocol;
mod report;
mod runner;
mod statistics;
mod store;

pub use analysis::{ArmRecords, ArmSummary};
pub use error::StudyError;
pub use protocol::{Arm, Overrides, Protocol, StudyFile, Variant};
pub use report::{AgainstPaper, Comparison, Nearness, Report, SwitchEffect};
pub use runner::{StudyWatcher, merge_studies, run_study};
pub use store::{Figures, Shard, StudyFolder, TrialRecord};
