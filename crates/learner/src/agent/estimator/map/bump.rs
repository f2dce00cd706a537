//! Bumper readings.

use serde::{Deserialize, Serialize};

/// Whether a wall stopped the robot, according to its bumper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Bump {
    /// The robot did not bump into a wall.
    No,
    /// The robot bumped into a wall, and stayed in its cell.
    Yes,
    /// The robot has no bumper: both are possible.
    Unfelt,
}

impl Bump {
    /// Returns the possible values, `true` for a bump.
    pub fn possible(self) -> impl Iterator<Item = bool> {
        let possible: &[bool] = match self {
            Self::No => &[false],
            Self::Yes => &[true],
            Self::Unfelt => &[false, true],
        };
        possible.iter().copied()
    }
}
