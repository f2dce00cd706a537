//! From a world file to a checked [`Maze`], and its shortest paths.

mod checks;
mod direction;
mod document;
mod error;
mod file;
mod maze;
mod name;
mod paths;
mod rows;
mod source;

pub use direction::{Direction, Moves};
pub use error::{Diagnostic, WorldError};
pub use maze::{Cell, Maze};
pub use paths::Paths;
