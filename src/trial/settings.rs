//! Everything that can be set for a trial.

use serde::{Deserialize, Serialize};

use crate::agent;
use crate::arena::{ArenaParams, PhysicsParams};
use crate::episode;
use xcs::bounds::OutOfRange;

/// All settings of a trial, by section.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// The learner.
    pub xcs: xcs::Params,
    /// Rewards and reward methods.
    pub reward: agent::Params,
    /// The repairs of `xcscr-plus`.
    pub plus: agent::PlusParams,
    /// Tabular methods.
    pub tabular: agent::TabularParams,
    /// Exploration.
    pub episode: episode::Params,
    /// What holds in every arena.
    pub arena: ArenaParams,
    /// The robot and its noise.
    pub physics: PhysicsParams,
}

impl Settings {
    /// Accepts the settings when each lies in its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        self.xcs.check()?;
        self.reward.check()?;
        self.plus.check()?;
        self.tabular.check()?;
        self.episode.check()?;
        self.arena.check()?;
        self.physics.check()
    }
}
