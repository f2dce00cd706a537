//! Occupancy maps as ROS 2 saves them (Nav2's map server): a YAML file beside an image.
//!
//! [`OccupancyMap::load`] reads one, [`Gridding`] makes a maze of it, and [`written`] writes a maze
//! as such a map.

mod cells;
mod error;
mod gridding;
mod header;
mod image;
mod passage;
mod passages;
mod placing;
mod raster;
mod rules;
mod writing;

use std::path::Path;

use nalgebra::Point2;

pub use error::MapError;
pub use gridding::{Gridded, Gridding};
pub use passage::Passage;
pub use writing::WrittenMap;

use header::Header;
use rules::Rules;
use writing::KeptWorld;

use super::Origin;

/// What is known of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Occupancy {
    /// The robot can be there.
    Free,
    /// Something is there.
    Occupied,
    /// Nobody looked.
    Unknown,
}

/// A grid of pixels, each free, occupied or unknown.
#[derive(Debug, Clone)]
pub struct OccupancyMap {
    /// Edge of a pixel, in metres.
    pub resolution_m: f64,
    /// The pose of the lower left corner of the image in the map frame.
    pub origin: Origin,
    /// Pixels in a row.
    pub width: usize,
    /// Rows of pixels.
    pub height: usize,
    /// Row by row from the top.
    values: Vec<i8>,
    rules: Rules,
    /// What a maze that was written as a map had beside its cells, and the grey levels of those.
    kept: Option<(KeptWorld, Vec<u8>)>,
    /// Pixels that count as free, but have the grey level with which Nav2 saves unknown ones
    /// (205): `free_thresh` is above 0.196.
    pub unknown_as_free: usize,
    /// Pixels that releases of Nav2 after Humble read in another way, because their grey level is
    /// at a threshold, or because the image has an opacity.
    pub disputed: usize,
}

impl OccupancyMap {
    /// Reads a map: the YAML file, and the image that it names, relative to its own folder.
    ///
    /// # Errors
    /// When one of the files is missing, unreadable or too large, or holds something else than the
    /// format allows; the message names file, key and value.
    pub fn load(yaml: &Path) -> Result<Self, MapError> {
        let header = Header::load(yaml)?;
        let rules = header.rules;
        let (mut values, mut greys) = (Vec::new(), Vec::new());
        let (mut unknown_as_free, mut disputed) = (0, 0);
        let [width, height] = image::read(&header.image, &mut |pixel| {
            values.push(rules.value(pixel));
            unknown_as_free += usize::from(rules.is_unknown_as_free(pixel));
            disputed += usize::from(rules.is_disputed(pixel));
            if header.kept.is_some() {
                greys.push(pixel.grey());
            }
        })?;
        Ok(Self {
            resolution_m: header.resolution_m,
            origin: header.origin,
            width,
            height,
            values,
            rules,
            kept: header.kept.map(|kept| (kept, greys)),
            unknown_as_free,
            disputed,
        })
    }

    /// The value of a pixel, counted from the upper left one, as Nav2's map server of ROS 2 Humble
    /// publishes it: 0 free, 100 occupied, -1 unknown, or between 0 and 100 in the modes `scale` and
    /// `raw`. Beyond the image -1.
    pub fn value(&self, col: usize, row: usize) -> i8 {
        match col < self.width && row < self.height {
            true => self.values[row * self.width + col],
            false => rules::UNKNOWN,
        }
    }

    /// What is known of the pixels, row by row from the top.
    fn occupancies(&self) -> impl Iterator<Item = Occupancy> + '_ {
        self.values.iter().map(|&value| self.rules.occupancy(value))
    }

    /// What is known of a pixel, counted from the upper left one; beyond the image nothing is.
    pub fn at(&self, col: usize, row: usize) -> Occupancy {
        self.rules.occupancy(self.value(col, row))
    }

    /// How many pixels are free, occupied and unknown.
    pub fn counts(&self) -> [usize; 3] {
        let count = |wanted| self.occupancies().filter(|&one| one == wanted).count();
        [Occupancy::Free, Occupancy::Occupied, Occupancy::Unknown].map(count)
    }

    fn is_free(&self, col: usize, row: usize) -> bool {
        self.at(col, row) == Occupancy::Free
    }

    /// The middle of a pixel in the map frame, in metres.
    fn in_map_m(&self, col: usize, row: usize) -> [f64; 2] {
        let x = (col as f64 + 0.5) * self.resolution_m;
        let y = (self.height as f64 - row as f64 - 0.5) * self.resolution_m;
        self.origin.to_map(Point2::new(x, y)).into()
    }
}
