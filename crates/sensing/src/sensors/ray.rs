//! Rays through the grid, cell by cell (Amanatides and Woo 1987). Lengths in metres of the grid frame.

use nalgebra::Vector2;

use super::Terrain;
use crate::whole::floor;

/// Returns the distance in metres from `origin` (grid frame) along the unit vector `direction` to the
/// first wall; `None` when that is more than `limit_m`.
pub fn cast(
    terrain: &dyn Terrain,
    origin: Vector2<f64>,
    direction: Vector2<f64>,
    limit_m: f64,
) -> Option<f64> {
    let size_m = terrain.cell_size_m();
    let (mut x, step_x, mut next_x, every_x) = axis(origin.x, direction.x, size_m);
    let (mut y, step_y, mut next_y, every_y) = axis(origin.y, direction.y, size_m);
    loop {
        let range;
        if next_x < next_y {
            (range, x, next_x) = (next_x, x + step_x, next_x + every_x);
        } else {
            (range, y, next_y) = (next_y, y + step_y, next_y + every_y);
        }
        if range.is_nan() || range > limit_m {
            return None;
        }
        if terrain.is_wall(x, y) {
            return Some(range);
        }
    }
}

/// Returns, along one axis: the first cell, the step to the next cell, the distance along the ray
/// to the next cell, and the distance between further cells.
fn axis(origin: f64, direction: f64, size_m: f64) -> (i32, i32, f64, f64) {
    let cell = floor(origin / size_m);
    let per_metre = 1.0 / direction.abs();
    let every = size_m * per_metre;
    if direction > 0.0 {
        let next = ((cell + 1.0) * size_m - origin) * per_metre;
        (cell as i32, 1, next, every)
    } else if direction < 0.0 {
        (cell as i32, -1, (origin - cell * size_m) * per_metre, every)
    } else {
        (cell as i32, 0, f64::INFINITY, f64::INFINITY)
    }
}
