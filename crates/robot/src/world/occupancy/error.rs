//! Errors in occupancy maps.

use std::io;
use std::path::PathBuf;

use crate::world::{Narrowest, WorldError};

/// The occupancy map cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// A file cannot be read.
    #[error("cannot read `{}`: {cause}", .path.display())]
    Unreadable {
        /// The YAML file or the image.
        path: PathBuf,
        /// The error of the operating system.
        cause: io::Error,
    },
    /// The YAML file is invalid, or a key has a wrong value.
    #[error("`{}` does not describe a map: {fault}", .path.display())]
    Header {
        /// The YAML file.
        path: PathBuf,
        /// Key, value, and the allowed values.
        fault: String,
    },
    /// The image is invalid.
    #[error("`{}` is not a readable image: {fault}", .path.display())]
    Image {
        /// The image.
        path: PathBuf,
        /// What is wrong with the image.
        fault: String,
    },
    /// The cell size is not allowed.
    #[error("{0}")]
    Cell(String),
    /// The goal is missing, and the map does not define one.
    #[error("a world needs a goal: add `--goal X,Y`, in metres of the map frame")]
    NoGoal,
    /// A point is outside the map, or in a wall.
    #[error("the {what} {}, {} lies {fault}", .at_m[0], .at_m[1])]
    Point {
        /// `start` or `goal`.
        what: &'static str,
        /// The point in the map frame, in metres.
        at_m: [f64; 2],
        /// Where the point is, and a suitable cell.
        fault: String,
    },
    /// No path leads to the goal, from any cell or from the start.
    #[error("no path in the grid leads to the goal{}", narrow(.0))]
    /// With a start: the narrowest place of the widest way, in the map frame; `None` if the map has
    /// no way.
    CutOff(Option<Option<Narrowest>>),
    /// The cells do not form a valid world.
    #[error(transparent)]
    World(#[from] WorldError),
}

/// Describes the narrowest place of the widest way, and what to do.
fn narrow(narrowest: &Option<Option<Narrowest>>) -> String {
    match narrowest {
        None => "; give a smaller `--cell`".to_owned(),
        Some(None) => ", and the map itself has no path either".to_owned(),
        Some(Some(Narrowest { at, width_m })) => format!(
            ": the widest way is {width_m:.2} m wide at {:.2},{:.2}; give a smaller `--cell`, or widen \
             the map there",
            at.x, at.y
        ),
    }
}
