//! Errors in occupancy maps.

use std::io;
use std::path::PathBuf;

use super::passage::Passage;
use crate::world::WorldError;

/// The largest number of passages that a message lists.
const MOST_LISTED: usize = 5;

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
    CutOff(Vec<Passage>),
    /// The cells do not form a valid world.
    #[error(transparent)]
    World(#[from] WorldError),
}

/// Lists the passages that are too narrow for a cell, and what to do.
fn narrow(passages: &[Passage]) -> String {
    if passages.is_empty() {
        return ", and the map itself has no path either".to_owned();
    }
    let list = passages.iter().take(MOST_LISTED).map(ToString::to_string);
    let more = match passages.len().saturating_sub(MOST_LISTED) {
        0 => String::new(),
        more => format!(", nor through {more} more passages"),
    };
    format!(
        ": no cell of the grid fits through {}{more}; give a smaller `--cell`, or widen the map there",
        list.collect::<Vec<_>>().join(", nor through ")
    )
}
