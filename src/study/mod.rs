//! Trials: from a seed to a result.

mod evaluation;
pub mod map;
mod plan;
mod resolve;
mod run_folder;
mod settings;
mod trial;

pub use evaluation::Evaluation;
pub use plan::{ArenaKind, Config, Plan, PlanError};
pub use resolve::{Origin, Resolved, SettingsError};
pub use run_folder::{RunFolder, RunFolderError};
pub use settings::Settings;
pub use trial::{Progress, Trial};
