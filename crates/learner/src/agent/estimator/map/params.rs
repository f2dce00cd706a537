//! Parameters and switches of maps.

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::state_map::MOST_MAPS;
use xcs::settings;

/// What is known beforehand of how actions displace the robot.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MotionPrior {
    /// The direction of each action.
    #[default]
    Known,
    /// Nothing: directions are learned from what successive percepts share.
    Learned,
}

settings! {
    section "map";

    /// Settings of the maps of `xcscr-plus` and `r-max`. Their size is bounded: cells that are at most 64 from the goal, or in
    /// exploration from the start, the last 2,000 steps of the last 100 episodes, and 500,000 beliefs.
    pub struct MapParams {
        /// The motion model: `known`, the direction of each action, or `learned` from what successive percepts share.
        motion_model: MotionPrior = MotionPrior::Known;
        /// Use the bumper, which is never misread. Without it a bump is inferred from percepts.
        feels_bumps: bool = true;
        /// Estimate how often cells are misread, and weigh percepts by that. Without it looked-up percepts are taken for
        /// right, and one cell in 500 of sensed percepts for misread.
        estimates_noise: bool = true;
        /// The most maps: goals that can be told apart.
        max_maps: u32 = MOST_MAPS as u32, in 1..=MOST_MAPS as u32;
    }
}
