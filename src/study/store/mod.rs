//! The files of a study: its folder, and a journal of finished trials for each shard.

pub(super) mod files;
pub(super) mod folder;
pub(super) mod journal;
pub(super) mod record;
mod records;
mod shard;

pub use folder::StudyFolder;
pub use record::{Driven, Figures, TrialRecord};
pub use shard::Shard;
