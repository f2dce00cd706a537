//! Rays through the grid, cell by cell (Amanatides and Woo 1987).

use nalgebra::Vector2;

use super::Terrain;
use crate::whole::floor;

/// How far it is from `origin` along the unit vector `direction` to the first wall, in cells;
/// `None` when that is more than `limit`.
pub fn cast(
    terrain: &dyn Terrain,
    origin: Vector2<f64>,
    direction: Vector2<f64>,
    limit: f64,
) -> Option<f64> {
    let (mut x, step_x, mut next_x, every_x) = axis(origin.x, direction.x);
    let (mut y, step_y, mut next_y, every_y) = axis(origin.y, direction.y);
    loop {
        let range;
        if next_x < next_y {
            (range, x, next_x) = (next_x, x + step_x, next_x + every_x);
        } else {
            (range, y, next_y) = (next_y, y + step_y, next_y + every_y);
        }
        if range.is_nan() || range > limit {
            return None;
        }
        if terrain.is_wall(x, y) {
            return Some(range);
        }
    }
}

/// Along one axis: the first cell, the step to the next one, how far along the ray that begins,
/// and how far it is from one to the next.
fn axis(origin: f64, direction: f64) -> (i32, i32, f64, f64) {
    let cell = floor(origin);
    let every = 1.0 / direction.abs();
    if direction > 0.0 {
        (cell as i32, 1, (cell + 1.0 - origin) * every, every)
    } else if direction < 0.0 {
        (cell as i32, -1, (origin - cell) * every, every)
    } else {
        (cell as i32, 0, f64::INFINITY, f64::INFINITY)
    }
}
