//! Why a maze cannot be simulated.

use xcs::bounds::OutOfRange;

/// A physics arena that cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PhysicsError {
    /// A setting lies outside of its range.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// The edges of the world join; a robot cannot drive through a border.
    #[error(
        "world `{world}` joins its edges (`\"wrap\": true`), which no physical floor does; use `--arena grid`, or close its border with walls"
    )]
    JoinedEdges {
        /// The world's name.
        world: String,
    },
    /// The world has diagonal moves, which lead through the corners of walls.
    #[error(
        "world `{world}` has eight moves, and a diagonal one would cut the corners of walls; use `--arena grid`, or set `\"moves\": 4`"
    )]
    EightMoves {
        /// The world's name.
        world: String,
    },
    /// The walls are too many to simulate.
    #[error(
        "world `{world}` needs {count} wall blocks, more than the {limit} that can be simulated; use `--arena grid`"
    )]
    TooManyWalls {
        /// The world's name.
        world: String,
        /// Rectangles that cover its walls.
        count: usize,
        /// The largest number allowed.
        limit: usize,
    },
}
