//! The arenas by their names.

use serde::{Deserialize, Serialize};

/// Which arena a trial runs in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ArenaKind {
    /// The robot drives in simulated physics.
    Physics,
    /// A move is a step from cell to cell.
    Grid,
}

impl ArenaKind {
    /// All arenas.
    pub const ALL: [Self; 2] = [Self::Physics, Self::Grid];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Grid => "grid",
        }
    }
}
