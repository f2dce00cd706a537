//! The arenas and their names.

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

/// The kind of arena that a trial runs in.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, IntoStaticStr, VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum ArenaKind {
    /// The robot drives in simulated physics.
    Physics,
    /// A move is a step from cell to cell.
    Grid,
}

impl ArenaKind {
    /// All arenas.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// Returns the name used on the command line and in files.
    pub fn name(self) -> &'static str {
        self.into()
    }
}
