//! What can be wrong with an occupancy map.

use std::io;
use std::path::PathBuf;

use super::passage::Passage;
use crate::world::WorldError;

/// The most passages that a message names one by one.
const MOST_LISTED: usize = 5;

/// A map that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// A file cannot be read.
    #[error("cannot read `{}`: {cause}", .path.display())]
    Unreadable {
        /// The YAML file or the image.
        path: PathBuf,
        /// What the operating system says.
        cause: io::Error,
    },
    /// The YAML file is none, or holds a key with the wrong value.
    #[error("`{}` does not describe a map: {fault}", .path.display())]
    Header {
        /// The YAML file.
        path: PathBuf,
        /// Key, value, and what is allowed.
        fault: String,
    },
    /// The image is none.
    #[error("`{}` is not an image that can be read: {fault}", .path.display())]
    Image {
        /// The image.
        path: PathBuf,
        /// What is wrong.
        fault: String,
    },
    /// The size of a cell does not fit.
    #[error("{0}")]
    Cell(String),
    /// A map says not where the goal is.
    #[error("a world needs a goal: add `--goal X,Y`, in metres of the map's frame")]
    NoGoal,
    /// A point lies outside, or in a wall.
    #[error("the {what} {}, {} lies {fault}", .at_m[0], .at_m[1])]
    Point {
        /// `start` or `goal`.
        what: &'static str,
        /// The point in the map's frame, in metres.
        at_m: [f64; 2],
        /// Where it lies, and a cell that would do.
        fault: String,
    },
    /// No cell, or not the start, has a path to the goal.
    #[error("no path in the grid leads to the goal{}", narrow(.0))]
    CutOff(Vec<Passage>),
    /// The cells are no world.
    #[error(transparent)]
    World(#[from] WorldError),
}

/// The passages in which a cell does not fit, and what to do.
fn narrow(passages: &[Passage]) -> String {
    if passages.is_empty() {
        return "; nor in the map itself".to_owned();
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
