//! Parameters and switches of maps.

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::state_map::MOST_CHARTS;
use xcs::settings;

/// What a robot knows of how its actions displace it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Odometry {
    /// The direction into which each action goes.
    #[default]
    Known,
    /// Nothing: directions are learned from what successive percepts share.
    None,
}

settings! {
    section "memory";

    /// Settings of the maps of `xcscr-plus` and `r-max`. Their size is bounded: on each map the cells that are at most
    /// 48 from the goal, in the sketch those that are at most 48 from the start, the last 200 steps of the last 100
    /// episodes, and 50,000 beliefs.
    pub struct MemoryParams {
        /// What the robot knows of how its actions displace it: `known`, the direction of each, or
        /// `none`, so that it learns them from what successive percepts share.
        odometry: Odometry = Odometry::Known;
        /// Does the robot feel whether it bumped, and so stands where it was? That is never misread. If
        /// not, only what it perceives tells.
        bumps: bool = true;
        /// Is it learned how often cells are misread, and what is perceived weighed by that? If not,
        /// what is looked up is taken for right, and of what is sensed one cell in 500 for misread.
        doubts: bool = true;
        /// Charts at most: goals that can be told apart.
        charts: u32 = MOST_CHARTS as u32, in 1..=MOST_CHARTS as u32;
    }
}
