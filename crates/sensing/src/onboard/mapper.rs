//! Maps beams to the cells around the robot.
//!
//! A beam ends where it enters a wall, and can enter a wall only where it crosses a line of the
//! grid. The crossing nearest to the measured range determines which cell is a wall. All cells that
//! the beam passed through before are free.

use nalgebra::Vector2;

use super::Surroundings;
use super::estimator::Ray;
use crate::whole::floor;

/// The evidence of one beam for a free cell or a wall ...
const HIT: i32 = 20;
/// ... and for free cells when nothing came back, because the beam may be a dropout.
const LOST: i32 = 7;
/// A beam that is in a cell for less than this distance, in metres, gives no evidence about it: the
/// estimated pose may be off by as much. In small cells the limit is the same share of the cell ...
const GRAZE_M: f64 = 0.15;
/// ... and in all cells this share of the range is added.
const GRAZE_SHARE: f64 = 0.02;
/// A beam that ends farther than this from every crossing, in metres, is an outlier. In small cells
/// the limit is the same share of the cell.
const STRAY_M: f64 = 0.2;

/// Adds the evidence of a beam to a map with cells of `cell_size_m`. A beam that does not come back
/// is followed for `lost_m`. A beam that hit something too near to be measured is assumed to end
/// after `nearest_m`.
pub(super) fn mark(
    map: &mut Surroundings,
    ray: &Ray,
    cell_size_m: f64,
    [nearest_m, lost_m]: [f64; 2],
) {
    let (weight, range) = match ray.range {
        Some(range) => (HIT, range.max(nearest_m)),
        None => (LOST, lost_m),
    };
    // The position of the beam is less certain at a greater distance.
    let graze = GRAZE_M * cell_size_m.min(1.0) + GRAZE_SHARE * range;
    let stray = STRAY_M * cell_size_m.min(1.0);
    let mut x = Axis::new(ray.origin.x, ray.direction.x, cell_size_m);
    let mut y = Axis::new(ray.origin.y, ray.direction.y, cell_size_m);
    let mut entered = 0.0;
    loop {
        let cell = [x.cell, y.cell];
        let left = x.next.min(y.next);
        if left.is_nan() || left > range + stray {
            return;
        }
        if x.next < y.next {
            x.cross()
        } else {
            y.cross()
        };
        let following = x.next.min(y.next);
        let ends = ray.range.is_some() && range < (left + following) / 2.0;
        if ends && (left - range).abs() > stray {
            return;
        }
        let stay = left - entered;
        if stay > graze {
            map.add(cell, weight);
        }
        if ends {
            // Near a corner the beam may have ended one cell before or behind.
            if following - left > graze && (entered == 0.0 || stay > graze) {
                map.add([x.cell, y.cell], -HIT);
            }
            return;
        }
        entered = left;
    }
}

/// A ray along one axis.
struct Axis {
    cell: i32,
    step: i32,
    /// The distance along the ray to the next cell, in metres.
    next: f64,
    /// The distance from one cell to the next along the ray, in metres.
    every: f64,
}

impl Axis {
    fn new(origin: f64, direction: f64, cell_size_m: f64) -> Self {
        let cell = floor(origin / cell_size_m);
        let per_metre = 1.0 / direction.abs();
        let (step, next) = if direction > 0.0 {
            (1, ((cell + 1.0) * cell_size_m - origin) * per_metre)
        } else if direction < 0.0 {
            (-1, (origin - cell * cell_size_m) * per_metre)
        } else {
            (0, f64::INFINITY)
        };
        Self {
            cell: cell as i32,
            step,
            next,
            every: cell_size_m * per_metre,
        }
    }

    fn cross(&mut self) {
        self.cell += self.step;
        self.next += self.every;
    }
}

/// Returns the cell (east, north) that contains a point of the grid frame.
pub(super) fn cell_of(point: Vector2<f64>, cell_size_m: f64) -> [i32; 2] {
    [point.x, point.y].map(|at| floor(at / cell_size_m) as i32)
}
