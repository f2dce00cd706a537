//! The main direction of the walls of a map.

use super::{Occupancy, OccupancyMap};
use crate::world::Origin;

/// The tried directions: from -45 to 45 degrees, in steps of a fifth of a degree.
const TRIED: i32 = 225;
const STEP_DEG: f64 = 0.2;
/// The walls have a main direction if its score exceeds that of the image by this factor.
const CLEARER: f64 = 1.1;
/// The most pixels that are looked at. Of more, evenly spread ones are taken.
const MOST_POINTS: usize = 1 << 18;

impl OccupancyMap {
    /// Returns the angle in radians from the lower edge of the image to most of its walls,
    /// counter-clockwise, from -45 to 45 degrees. Returns 0 if no direction is clearly better than
    /// that of the image.
    ///
    /// In the main direction the surfaces of the walls lie on few lines: the sum of the squares of the
    /// numbers of pixels on each line is largest there.
    pub fn wall_direction_rad(&self) -> f64 {
        let places = (0..self.height).flat_map(|row| (0..self.width).map(move |col| (col, row)));
        let surface = places.filter(|&(col, row)| self.is_surface(col, row));
        let spread = surface.clone().count().div_ceil(MOST_POINTS).max(1);
        let points: Vec<[f64; 2]> = surface
            .step_by(spread)
            .map(|(col, row)| [col as f64 + 0.5, (self.height - row) as f64 - 0.5])
            .collect();
        let diagonal = (self.width + self.height) as f64;
        let score = |angle_rad: f64| -> u64 {
            let turned = Origin::from([0.0, 0.0, angle_rad]);
            let mut lines = vec![[0_u64; 2]; 2 * diagonal as usize + 2];
            for &point in &points {
                let along = turned.to_grid(point.into());
                for (axis, at) in [along.x, along.y].into_iter().enumerate() {
                    lines[(at + diagonal) as usize][axis] += 1;
                }
            }
            lines.iter().flatten().map(|count| count * count).sum()
        };
        let straight = score(0.0);
        let angles = (-TRIED..TRIED).map(|step| (f64::from(step) * STEP_DEG).to_radians());
        let mut best = (straight, 0.0);
        for angle_rad in angles {
            let found = score(angle_rad);
            if found > best.0 {
                best = (found, angle_rad);
            }
        }
        match best.0 as f64 > CLEARER * straight as f64 {
            true => best.1,
            false => 0.0,
        }
    }

    /// Returns true if a pixel is occupied, and one beside it is free.
    fn is_surface(&self, col: usize, row: usize) -> bool {
        let before = |at: usize| at.wrapping_sub(1);
        let beside = [
            (before(col), row),
            (col + 1, row),
            (col, before(row)),
            (col, row + 1),
        ];
        self.at(col, row) == Occupancy::Occupied
            && beside
                .iter()
                .any(|&(col, row)| self.at(col, row) == Occupancy::Free)
    }
}
