//! What is felt of walls.

use serde::{Deserialize, Serialize};

/// What a robot felt of a wall that barred its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Bump {
    /// There was none.
    No,
    /// It bumped against one, and stayed where it was.
    Yes,
    /// It cannot feel walls: either may be true.
    Unfelt,
}

impl Bump {
    /// What may have happened, as `true` for a bump.
    pub fn possible(self) -> impl Iterator<Item = bool> {
        let possible: &[bool] = match self {
            Self::No => &[false],
            Self::Yes => &[true],
            Self::Unfelt => &[false, true],
        };
        possible.iter().copied()
    }
}
