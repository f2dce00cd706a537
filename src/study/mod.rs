//! Trials, from a seed to a result; and studies, from many trials to an answer.

mod checkpoint;
mod checksum;
mod error;
mod evaluation;
mod figures;
mod folder;
mod journal;
mod lock;
mod plan;
mod protocol;
mod record;
mod report;
mod resolve;
mod run_folder;
mod runner;
mod settings;
mod shard;
pub mod statistics;
mod summary;
mod tables;
mod trial;

pub use checkpoint::{Checkpoint, CheckpointError, seal, unseal};
pub use error::StudyError;
pub use evaluation::Evaluation;
pub use folder::StudyFolder;
pub use plan::{ArenaKind, Config, Plan, PlanError};
pub use protocol::{Arm, Overrides, Protocol, StudyFile, Variant};
pub use record::{Figures, TrialRecord};
pub use report::{AgainstPaper, Comparison, Report, SwitchEffect};
pub use resolve::{Origin, Resolved, SettingsError};
pub use run_folder::{RunFolder, RunFolderError};
pub use runner::{StudyWatcher, merge_studies, run_study};
pub use settings::Settings;
pub use shard::Shard;
pub use summary::{ArmRecords, ArmSummary};
pub use trial::{Progress, Trial};
