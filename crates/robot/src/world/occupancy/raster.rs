//! The pixels that the robot can occupy.

use std::ops::Range;

use nalgebra::Point2;

use super::{Occupancy, OccupancyMap};
use crate::world::{Origin, Solid};

/// The pixels of a map: free or not.
pub(super) struct Raster<'a> {
    pub map: &'a OccupancyMap,
    /// Row by row from the top.
    free: Vec<bool>,
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
        };
        if speck > 0 {
            raster.despeckle(speck);
        }
        raster
    }

    pub fn is_free(&self, col: usize, row: usize) -> bool {
        self.free[row * self.map.width + col]
    }

    /// Returns the true shape of the walls, around all free pixels. `grid_m` is the lower left corner
    /// of the grid, in metres to the right and upward from the lower left corner of the image.
    pub fn solid(&self, grid_m: Point2<f64>) -> Solid {
        let (width, height) = (self.map.width, self.map.height);
        let row_is_used = |row: &usize| self.free[row * width..][..width].contains(&true);
        let col_is_used = |col: &usize| {
            let mut col = self.free[*col..].iter().step_by(width);
            col.any(|&free| free)
        };
        let rows = used(height, row_is_used);
        let cols = used(width, col_is_used);
        let pixel_m = self.map.resolution_m;
        let corner = Origin {
            x_m: cols.start as f64 * pixel_m - grid_m.x,
            y_m: (height - rows.end) as f64 * pixel_m - grid_m.y,
            yaw_rad: 0.0,
        };
        let bits = rows.flat_map(|row| cols.clone().map(move |col| row * width + col));
        let bits = bits.map(|at| !self.free[at]).collect();
        Solid::new(cols.len(), bits, pixel_m, corner)
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
                group.into_iter().for_each(|pixel| self.free[pixel] = true);
            }
        }
    }
}

/// Returns the range of the numbers below `count` for which `is_used` is true somewhere.
fn used(count: usize, is_used: impl Fn(&usize) -> bool) -> Range<usize> {
    let first = (0..count).find(&is_used).unwrap_or(0);
    let last = (0..count).rev().find(&is_used).unwrap_or(count - 1);
    first..last + 1
}

/// A summed-area table: counts the free pixels in any rectangle with four look-ups.
pub(super) struct Sums {
    width: usize,
    /// For each corner of a pixel: the number of free pixels above and to the left of it.
    sums: Vec<u32>,
}

impl Sums {
    pub fn new(raster: &Raster<'_>) -> Self {
        let width = raster.map.width + 1;
        let mut sums = vec![0; width * (raster.map.height + 1)];
        for row in 0..raster.map.height {
            let mut here = 0;
            for col in 0..raster.map.width {
                here += u32::from(raster.is_free(col, row));
                sums[(row + 1) * width + col + 1] = sums[row * width + col + 1] + here;
            }
        }
        Self { width, sums }
    }

    /// Returns the number of free pixels in a rectangle.
    pub fn free_in(&self, cols: Range<usize>, rows: Range<usize>) -> usize {
        let sum = |col, row| self.sums[row * self.width + col];
        let plus = sum(cols.end, rows.end) + sum(cols.start, rows.start);
        (plus - sum(cols.start, rows.end) - sum(cols.end, rows.start)) as usize
    }
}
