//! World files, the checked [`Maze`], and shortest paths.

mod around;
mod auxiliary;
mod bundled;
mod cache;
mod checks;
mod direction;
mod document;
mod draw;
mod error;
mod facts;
mod file;
mod floor;
mod generate;
mod json;
mod location;
mod maze;
mod name;
mod near;
mod occupancy;
mod origin;
mod paths;
mod rows;
mod slip;
mod source;
mod starts;

pub use around::Content;
pub use bundled::{bundled_world, bundled_worlds};
pub use direction::{Direction, Moves};
pub use error::{Diagnostic, WorldError};
pub use facts::{Facts, FloorFacts};
pub use generate::{MazeKind, Recipe};
pub use maze::{Cell, Maze};
pub use occupancy::{Gridded, Gridding, MapError, Occupancy, OccupancyMap, Passage, WrittenMap};
pub use origin::Origin;
pub use paths::Paths;
pub use starts::Starts;
