//! Settings of maps.

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::state_map::MOST_MAPS;
use xcs::settings;

/// Prior knowledge of the motion model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MotionPrior {
    /// The direction of each action is known.
    #[default]
    Known,
    /// Nothing is known: directions are learned from successive percepts.
    Learned,
}

settings! {
    section "map";

    /// Settings of the maps of `xcscr-plus` and `r-max`. A map contains cells at most 64 from the goal (in
    /// exploration, from the start). Limits: the last 2,000 steps of the last 100 episodes, 500,000 beliefs.
    pub struct MapParams {
        /// The motion model: `known`, the direction of each action, or `learned` from successive
        /// percepts.
        motion_model: MotionPrior = MotionPrior::Known;
        /// Use the bumper, which is free of errors. Without it, bumps are inferred from percepts.
        feels_bumps: bool = true;
        /// Estimate the observation error and weight percepts by it. Without it, percepts that are
        /// read from the maze are treated as correct, and an error of one cell in 500 is assumed for sensed percepts.
        estimates_noise: bool = true;
        /// The maximum number of maps, one per distinguishable goal.
        max_maps: u32 = MOST_MAPS as u32, in 1..=MOST_MAPS as u32;
    }
}
