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
mod writing;

use std::path::Path;

use nalgebra::Point2;

pub use error::MapError;
pub use gridding::{Gridded, Gridding};
pub use passage::Passage;
pub use writing::WrittenMap;

use header::Header;
use image::Image;
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
    pixels: Vec<Occupancy>,
    /// What a maze that was written as a map had beside its cells, and the grey levels of those.
    kept: Option<(KeptWorld, Vec<u8>)>,
    /// Grey levels so near to a threshold that rounding decides, and how many pixels have them.
    pub doubtful: Vec<(u8, usize)>,
}

impl OccupancyMap {
    /// Reads a map: the YAML file, and the image that it names, relative to its own folder.
    ///
    /// # Errors
    /// When one of the files is missing, unreadable or too large, or holds something else than the
    /// format allows; the message names file, key and value.
    pub fn load(yaml: &Path) -> Result<Self, MapError> {
        let header = Header::load(yaml)?;
        let image = Image::load(&header.image)?;
        let state = |grey: u8, opaque: bool| match opaque {
            true => header.occupancy(grey),
            false => Occupancy::Unknown,
        };
        let pixels = image.greys.iter().enumerate();
        let pixels = pixels
            .map(|(at, &grey)| state(grey, image.is_opaque(at)))
            .collect();
        Ok(Self {
            resolution_m: header.resolution_m,
            origin: header.origin,
            width: image.width,
            height: image.height,
            pixels,
            doubtful: doubtful(&header, &image),
            kept: header.kept.map(|kept| (kept, image.greys)),
        })
    }

    /// What is known of a pixel, counted from the upper left one; beyond the image nothing is.
    pub fn at(&self, col: usize, row: usize) -> Occupancy {
        match col < self.width && row < self.height {
            true => self.pixels[row * self.width + col],
            false => Occupancy::Unknown,
        }
    }

    /// How many pixels are free, occupied and unknown.
    pub fn counts(&self) -> [usize; 3] {
        let count = |wanted| self.pixels.iter().filter(|&&one| one == wanted).count();
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

/// The grey levels in the image within 1/255 of a threshold.
fn doubtful(header: &Header, image: &Image) -> Vec<(u8, usize)> {
    let mut counts = [0_usize; 256];
    image
        .greys
        .iter()
        .for_each(|&grey| counts[usize::from(grey)] += 1);
    let levels = (0..=u8::MAX).zip(counts);
    levels
        .filter(|&(grey, count)| count > 0 && header.is_doubtful(grey))
        .collect()
}
