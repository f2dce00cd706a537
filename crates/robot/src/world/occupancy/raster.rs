//! The pixels that the robot can occupy.

use std::ops::Range;

use nalgebra::Point2;

use super::{Occupancy, OccupancyMap};
use crate::world::{Origin, Solid};

/// The width of the solid ring around all free pixels, in pixels. It stops the robot where the image
/// ends.
const RING: isize = 2;

/// The pixels of a map: free or not.
pub(super) struct Raster<'a> {
    pub map: &'a OccupancyMap,
    /// Row by row from the top.
    free: Vec<bool>,
    /// The number of pixels that were erased as noise.
    pub erased: usize,
}

impl<'a> Raster<'a> {
    /// Treats groups of at most `speck` connected pixels that are not free as noise.
    pub fn new(map: &'a OccupancyMap, unknown_is_free: bool, speck: usize) -> Self {
        let is_free = |occupancy| match occupancy {
            Occupancy::Free => true,
            Occupancy::Occupied => false,
            Occupancy::Unknown => unknown_is_free,
        };
        let mut raster = Self {
            map,
            free: map.occupancies().map(is_free).collect(),
            erased: 0,
        };
        if speck > 0 {
            raster.despeckle(speck);
        }
        raster
    }

    /// Returns the shape of the walls in the frame of the image, whose origin is in its lower left
    /// corner.
    pub fn in_image(&self) -> Solid {
        let bits = self.free.iter().map(|free| !free).collect();
        Solid::new(
            self.map.width,
            bits,
            self.map.resolution_m,
            Origin::default(),
        )
    }

    /// Returns the shape of the walls around all free pixels, in a grid whose lower left corner has
    /// this pose in the frame of the image. A disc of `radius_m` is clear on every move.
    pub fn solid(&self, grid: Origin, radius_m: f64) -> Solid {
        let (width, height) = (self.map.width, self.map.height);
        let row_is_used = |row: &usize| self.free[row * width..][..width].contains(&true);
        let col_is_used = |col: &usize| {
            let mut col = self.free[*col..].iter().step_by(width);
            col.any(|&free| free)
        };
        let rows = used(height, row_is_used);
        let cols = used(width, col_is_used);
        let corner = [cols.start, height as isize - rows.end].map(|pixels| pixels as f64);
        let corner = grid.to_grid(Point2::from(corner) * self.map.resolution_m);
        let corner = Origin {
            x_m: corner.x,
            y_m: corner.y,
            yaw_rad: 0.0 - grid.yaw_rad,
        };
        let is_solid = |col: isize, row: isize| {
            // Negative numbers become large ones.
            let (col, row) = (col as usize, row as usize);
            col >= width || row >= height || !self.free[row * width + col]
        };
        let pixels = rows.flat_map(|row| cols.clone().map(move |col| (col, row)));
        let bits = pixels.map(|(col, row)| is_solid(col, row)).collect();
        let mut solid = Solid::new(cols.len(), bits, self.map.resolution_m, corner);
        solid.radius_m = radius_m;
        solid
    }

    /// Explains why no cell is free, for a message.
    pub fn reason(&self) -> String {
        let [_, occupied, unknown] = self.map.counts();
        format!(
            ": {occupied} of the {} pixels are occupied and {unknown} unknown; check `negate` and \
             the thresholds of the map, or take unknown pixels as free (`--unknown free`)",
            self.free.len()
        )
    }

    /// Frees small groups of pixels. Pixels that touch at a corner are connected.
    fn despeckle(&mut self, speck: usize) {
        let (width, height) = (self.map.width, self.map.height);
        let mut seen = self.free.clone();
        for first in 0..seen.len() {
            if std::mem::replace(&mut seen[first], true) {
                continue;
            }
            let (mut next, mut group, mut size) = (vec![first], Vec::new(), 0);
            while let Some(pixel) = next.pop() {
                size += 1;
                if size <= speck {
                    group.push(pixel);
                }
                let (col, row) = (pixel % width, pixel / width);
                for row in row.saturating_sub(1)..(row + 2).min(height) {
                    for col in col.saturating_sub(1)..(col + 2).min(width) {
                        let other = row * width + col;
                        if !std::mem::replace(&mut seen[other], true) {
                            next.push(other);
                        }
                    }
                }
            }
            if size <= speck {
                self.erased += size;
                group.into_iter().for_each(|pixel| self.free[pixel] = true);
            }
        }
    }
}

/// Returns the range of the numbers below `count` for which `is_used` is true somewhere, and a few
/// more on both sides.
fn used(count: usize, is_used: impl Fn(&usize) -> bool) -> Range<isize> {
    let first = (0..count).find(&is_used).unwrap_or(0);
    let last = (0..count).rev().find(&is_used).unwrap_or(count - 1);
    first as isize - RING..last as isize + 1 + RING
}
