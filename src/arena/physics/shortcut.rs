//! Motion without the engine while no wall is near: faster, with the same bits.
//!
//! A free body moves in the engine as in [`coast`]. That holds while no wall is within the
//! engine's prediction distance *and* no wall pushed in the engine's last step (the next one
//! would start with that push), with contact recycling, continuous collision detection, the cap
//! on turn rates, gravity and damping off. `tests/world/physics.rs` compares the bits.

use rapier2d::prelude::{Pose, RigidBody, Rotation};

use super::{SOLVER_ITERATIONS, STEP_S};
use crate::world::{Cell, Maze};

/// Distance in cells beyond the engine's prediction distance: more than any rounding.
const MARGIN: f64 = 0.001;

/// Knows how close to a wall a robot must be for the engine to look at the two.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clearance {
    radius: f64,
    /// The engine's prediction distance for slow bodies, in cells.
    prediction: f64,
}

impl Clearance {
    /// For a robot of `radius` in an engine that predicts contacts by `prediction`, in cells.
    pub(super) fn new(radius: f64, prediction: f64) -> Self {
        Self { radius, prediction }
    }

    /// Are all walls out of the engine's sight during the next step of `body`?
    pub(super) fn is_clear(&self, maze: &Maze, body: &RigidBody) -> bool {
        // Fast bodies are predicted as far as they move in a step.
        let travel = f64::from(body.linvel().length()) * STEP_S;
        let reach = self.radius + self.prediction.max(travel) + MARGIN;
        let at = body.translation();
        // With a longer reach there would be walls on both sides to look at.
        reach < 0.5 && is_free_around(maze, f64::from(at.x), f64::from(at.y), reach)
    }
}

/// Are all walls at least `reach` (below half a cell) away from the point `x`, `y`?
fn is_free_around(maze: &Maze, x: f64, y: f64, reach: f64) -> bool {
    let (col, row) = (x.floor(), f64::from(maze.height()) - 1.0 - y.floor());
    let (east, gap_x) = nearer_side(x - x.floor(), reach);
    let (north, gap_y) = nearer_side(y - y.floor(), reach);
    let is_wall = |east: f64, north: f64| {
        // Negative numbers become 0 here, which is the border: a wall.
        let (col, row) = ((col + east) as u16, (row - north) as u16);
        maze.is_wall(Cell { col, row })
    };
    let reaches_corner = gap_x * gap_x + gap_y * gap_y < reach * reach;
    !(is_wall(0.0, 0.0)
        || is_wall(east, 0.0)
        || is_wall(0.0, north)
        || reaches_corner && is_wall(east, north))
}

/// The step to the neighbouring cell within `reach` along one axis (0 when there is none), and
/// the gap to it, for a point at `offset` in its cell.
fn nearer_side(offset: f64, reach: f64) -> (f64, f64) {
    if offset < reach {
        (-1.0, offset)
    } else if 1.0 - offset < reach {
        (1.0, 1.0 - offset)
    } else {
        (0.0, f64::INFINITY)
    }
}

/// Moves a body for one step as the engine would do, by the engine's own formula.
pub(super) fn coast(body: &mut RigidBody) {
    let substep = STEP_S as f32 / SOLVER_ITERATIONS as f32;
    let (velocity, turn) = (body.linvel(), body.angvel() * substep);
    let Pose {
        mut translation,
        mut rotation,
    } = *body.position();
    for _ in 0..SOLVER_ITERATIONS {
        let (re, im) = (rotation.re, rotation.im);
        rotation = Rotation::from_cos_sin_unchecked(re - turn * im, im + turn * re).normalize();
        translation += velocity * substep;
    }
    body.set_position(Pose::from_parts(translation, rotation), false);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ROWS: [&str; 5] = ["######", "#S.#.#", "##...#", "#..#G#", "######"];

    /// From a point to the nearest wall cell, by looking at all of them.
    fn distance_to_walls(maze: &Maze, x: f64, y: f64) -> f64 {
        let beyond = |low: f64, at: f64| -> f64 { (low - at).max(at - low - 1.0).max(0.0) };
        let distance = |cell: Cell| {
            let low_y = f64::from(maze.height() - cell.row) - 1.0;
            beyond(f64::from(cell.col), x).hypot(beyond(low_y, y))
        };
        let walls = maze.cells().filter(|&cell| maze.is_wall(cell));
        walls.map(distance).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #[test]
        fn the_neighbourhood_sees_every_wall_within_reach(
            x in 0.0..6.0_f64, y in 0.0..5.0_f64, reach in 0.1..0.499_f64,
        ) {
            let maze: Maze = Maze::from_json(format!(r#"{{ "rows": {ROWS:?} }}"#).as_bytes(), "m").unwrap();
            let distance: f64 = distance_to_walls(&maze, x, y);
            prop_assume!((distance - reach).abs() > 1e-9);
            prop_assert_eq!(is_free_around(&maze, x, y, reach), distance > reach);
        }
    }
}
