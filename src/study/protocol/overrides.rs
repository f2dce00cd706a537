//! What the command line changes in a study.

use crate::arena::ArenaKind;

/// What the command line says otherwise than the study file.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Trials per arm.
    pub trials: Option<usize>,
    /// Episodes per trial.
    pub episodes: Option<u32>,
    /// Root seed of all trials.
    pub seed: Option<u64>,
    /// The only arena.
    pub arena: Option<ArenaKind>,
    /// Settings, as `section.key=value`, which win over all others.
    pub sets: Vec<String>,
}
