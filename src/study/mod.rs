//! Trials, from a seed to a result; and studies, from many trials to an answer.

mod error;
mod figures;
mod folder;
mod journal;
pub mod map;
mod protocol;
mod record;
mod report;
mod run_folder;
mod runner;
mod shard;
pub mod statistics;
mod summary;
mod tables;
mod trial;

pub use error::StudyError;
pub use folder::StudyFolder;
pub use protocol::{Arm, Overrides, Protocol, StudyFile, Variant};
pub use record::{Figures, TrialRecord};
pub use report::{AgainstPaper, Comparison, Report, SwitchEffect, Table};
pub use run_folder::{RunFolder, RunFolderError};
pub use runner::{StudyWatcher, merge_studies, run_study};
pub use shard::Shard;
pub use summary::{ArmRecords, ArmSummary};
pub use trial::{
    ArenaKind, Checkpoint, CheckpointError, Condensed, Config, Evaluation, MOST_PERCEPTS,
    MOST_TOML_BYTES, Origin, Plan, PlanError, Progress, Resolved, Settings, SettingsError, Trial,
    seal, unseal,
};
