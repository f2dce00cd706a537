//! Trials: from a seed to a result.

mod resolve;
mod settings;
mod trial;

pub use resolve::{Origin, Resolved, SettingsError};
pub use settings::Settings;
pub use trial::{ArenaKind, Plan, PlanError, Progress, Trial};
