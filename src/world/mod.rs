//! From a world file to a checked [`Maze`], and its shortest paths.

mod direction;
mod maze;
mod paths;

pub use direction::{Direction, Moves};
pub use maze::{Cell, Maze};
pub use paths::Paths;
