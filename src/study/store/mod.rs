//! What a study keeps on disk: its folder, and a journal of finished trials for each shard.

mod files;
pub(super) mod folder;
pub(super) mod journal;
mod record;
mod shard;

pub use folder::StudyFolder;
pub use record::{Driven, Figures, TrialRecord};
pub use shard::Shard;
