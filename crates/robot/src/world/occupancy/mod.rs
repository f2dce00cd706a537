//! Occupancy maps in the format of ROS 2 (Nav2's map server): a YAML file next to an image.
//!
//! [`OccupancyMap::load`] reads a map, [`Gridding`] converts it to a maze, and [`WrittenMap`] is a
//! maze written as a map.

mod cells;
mod direction;
mod error;
mod gridding;
mod header;
mod image;
mod placing;
mod raster;
mod rules;
mod writing;

use std::path::Path;

pub use error::MapError;
pub use gridding::{Gridded, Gridding};
pub use writing::WrittenMap;

use header::Header;
use rules::Rules;

use super::Origin;

/// The occupancy of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Occupancy {
    /// The robot can be there.
    Free,
    /// Something is there.
    Occupied,
    /// Never observed.
    Unknown,
}

/// A grid of pixels, each free, occupied or unknown.
#[derive(Debug, Clone)]
pub struct OccupancyMap {
    /// The edge of a pixel, in metres.
    pub resolution_m: f64,
    /// The pose of the lower left corner of the image in the map frame.
    pub origin: Origin,
    /// The number of pixels in a row.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
    /// Row by row from the top.
    values: Vec<i8>,
    rules: Rules,
    /// For a maze that was written as a map: its world file.
    world: Option<String>,
    /// The number of pixels that count as free, but have the grey level with which Nav2 saves
    /// unknown ones (205). This happens when `free_thresh` is above 0.196.
    pub unknown_as_free: usize,
    /// The number of pixels that releases of Nav2 after Humble interpret differently, because their
    /// grey level is at a threshold, or because the image has an opacity.
    pub disputed: usize,
}

impl OccupancyMap {
    /// Reads a map: the YAML file, and the image that it names, relative to its own folder.
    ///
    /// # Errors
    /// When one of the files is missing, unreadable, too large or not in the expected format. The
    /// message names file, key and value.
    pub fn load(yaml: &Path) -> Result<Self, MapError> {
        let header = Header::load(yaml)?;
        let rules = header.rules;
        let mut values = Vec::new();
        let (mut unknown_as_free, mut disputed) = (0, 0);
        let [width, height] = image::read(&header.image, &mut |pixel| {
            values.push(rules.value(pixel));
            unknown_as_free += usize::from(rules.is_unknown_as_free(pixel));
            disputed += usize::from(rules.is_disputed(pixel));
        })?;
        Ok(Self {
            resolution_m: header.resolution_m,
            origin: header.origin,
            width,
            height,
            values,
            rules,
            world: header.world,
            unknown_as_free,
            disputed,
        })
    }

    /// Returns the value of a pixel, counted from the upper left one, as Nav2's map server of ROS 2
    /// Humble publishes it. 0 is free, 100 occupied and -1 unknown; the modes `scale` and `raw`
    /// also have values between 0 and 100. Pixels outside the image are -1.
    pub fn value(&self, col: usize, row: usize) -> i8 {
        match col < self.width && row < self.height {
            true => self.values[row * self.width + col],
            false => rules::UNKNOWN,
        }
    }

    /// Returns the occupancies of the pixels, row by row from the top.
    fn occupancies(&self) -> impl Iterator<Item = Occupancy> + '_ {
        self.values.iter().map(|&value| self.rules.occupancy(value))
    }

    /// Returns the occupancy of a pixel, counted from the upper left one. Pixels outside the image
    /// are unknown.
    pub fn at(&self, col: usize, row: usize) -> Occupancy {
        self.rules.occupancy(self.value(col, row))
    }

    /// Returns the numbers of free, occupied and unknown pixels.
    pub fn counts(&self) -> [usize; 3] {
        let count = |wanted| self.occupancies().filter(|&one| one == wanted).count();
        [Occupancy::Free, Occupancy::Occupied, Occupancy::Unknown].map(count)
    }

    fn is_free(&self, col: usize, row: usize) -> bool {
        self.at(col, row) == Occupancy::Free
    }
}
