//! State estimators: the percept itself is the state, or the state is a cell of a learned map.

pub mod aliasing;
pub mod belief;
pub mod map;

use serde::{Deserialize, Serialize};

/// What represents the state.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Estimator {
    /// The percept, until experience contradicts this; then the cell on a map.
    #[default]
    Auto,
    /// The percept.
    Percept,
    /// The cell on a map that the learner builds.
    Map,
}
