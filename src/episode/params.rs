//! How episodes explore.

use serde::{Deserialize, Serialize};

use crate::bounds::{OutOfRange, within};

/// Settings of the episode loop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Params {
    /// p_explr: the probability that a step explores, taking a random action; 0 to 1.
    pub explore: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self { explore: 0.3 }
    }
}

impl Params {
    /// Accepts the settings when each lies in its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("episode.explore", self.explore, 0.0..=1.0)
    }
}
