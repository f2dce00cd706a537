//! The pixels that the robot can occupy.

use std::ops::Range;

use super::{Occupancy, OccupancyMap};

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
