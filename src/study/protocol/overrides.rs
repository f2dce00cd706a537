//! Command-line overrides of a study file.

use crate::arena::ArenaKind;

/// The values on the command line, which override those of the study file.
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Trials per arm.
    pub trials: Option<usize>,
    /// Episodes per trial.
    pub episodes: Option<u32>,
    /// Root seed of all trials.
    pub seed: Option<u64>,
    /// The method that the report compares with each other one.
    pub reference: Option<String>,
    /// The arena, which replaces the arenas of the study.
    pub arena: Option<ArenaKind>,
    /// Settings as `section.key=value`, which override all others.
    pub sets: Vec<String>,
}
