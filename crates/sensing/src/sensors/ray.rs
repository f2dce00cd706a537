//! Rays through a raster, pixel by pixel (Amanatides and Woo 1987).

use nalgebra::Vector2;

use super::Terrain;
use crate::whole::floor;

/// The shortest free length, in pixels, for which skipping costs less than stepping.
const WORTH_SKIPPING: f64 = 3.0;

/// Returns the distance in metres from `origin` (grid frame) along the unit vector `direction` to
/// the first wall; `None` when that is more than `limit_m`.
pub fn cast(
    terrain: &impl Terrain,
    origin: Vector2<f64>,
    direction: Vector2<f64>,
    limit_m: f64,
) -> Option<f64> {
    let Some(corner) = terrain.corner_in_grid() else {
        return cast_in_raster(terrain, origin, direction, limit_m);
    };
    let origin = corner.inverse_transform_point(&origin.into()).coords;
    let direction = corner.rotation.inverse() * direction;
    // Far from walls the ray skips what is known to be free.
    let mut skipped = 0.0;
    while skipped <= limit_m {
        let at = origin + skipped * direction;
        let [col, row] = [at.x, at.y].map(|at| floor(at / terrain.pixel_m()) as i32);
        let clear_m = terrain.clear_m(col, row);
        if clear_m < WORTH_SKIPPING * terrain.pixel_m() {
            break;
        }
        skipped += clear_m;
    }
    let at = origin + skipped * direction;
    let range = cast_in_raster(terrain, at, direction, limit_m - skipped)?;
    Some(skipped + range)
}

/// Returns the same for a ray in the frame of the raster.
fn cast_in_raster(
    terrain: &impl Terrain,
    origin: Vector2<f64>,
    direction: Vector2<f64>,
    limit_m: f64,
) -> Option<f64> {
    let size_m = terrain.pixel_m();
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
        if terrain.is_solid(x, y) {
            return Some(range);
        }
    }
}

/// Returns, along one axis: the first pixel, the step to the next pixel, the distance along the
/// ray to the next pixel, and the distance between further pixels.
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
