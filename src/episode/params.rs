//! How episodes explore.

use serde::{Deserialize, Serialize};

use xcs::bounds::{OutOfRange, within};

/// Settings of the episode loop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Params {
    /// p_explr: the probability that a step explores, taking a random action; 0 to 1.
    pub explore: f64,
    /// Take turns, as in Wilson's experiments with XCS: an episode in which every action is
    /// random and the GA runs, then one that is greedy and in which it rests. Both learn.
    /// `explore` has no meaning then.
    pub alternate: bool,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            explore: 0.3,
            alternate: false,
        }
    }
}

impl Params {
    /// Does episode `number` (from 1) only explore (`Some(true)`), only exploit (`Some(false)`),
    /// or mix both?
    pub fn turn_of(&self, number: u32) -> Option<bool> {
        self.alternate.then_some(number % 2 == 1)
    }

    /// Accepts the settings when each lies in its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("episode.explore", self.explore, 0.0..=1.0)
    }
}
