//! Motion without the engine while no wall is in the way: faster, and bit-identical.
//!
//! In the engine a free body moves as in [`coast`]. This holds under two conditions. Each wall
//! within the engine's prediction distance stays out of touch during the whole step, so that its
//! contact gets no impulse. *And* no wall pushed in the engine's last step, because the next step
//! would start with that push. Contact recycling, continuous collision detection, the cap on turn
//! rates, gravity and damping must be off. `tests/world/physics.rs` compares the bits.

use nalgebra::Vector2;
use rapier2d::prelude::{Pose, RigidBody, Rotation};

use super::{SOLVER_ITERATIONS, STEP_S};
use crate::world::Solid;

/// How many steps ahead the engine looks: it pushes back what would touch within its step and one
/// substep more. At the end of a step it tests the next substep.
const LOOKAHEAD_STEPS: f64 = 1.0 + 1.0 / SOLVER_ITERATIONS as f64;

/// Distance in metres beyond the engine's prediction distance; larger than any rounding error.
const MARGIN_M: f64 = 0.001;

/// Finds the walls that the engine considers, and tests whether the robot can touch one of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clearance {
    radius_m: f64,
    /// The engine's prediction distance for slow bodies, in metres.
    prediction_m: f64,
}

impl Clearance {
    /// Creates a check for a robot of `radius_m` in an engine with a prediction distance of
    /// `prediction_m`.
    pub(super) fn new(radius_m: f64, prediction_m: f64) -> Self {
        Self {
            radius_m,
            prediction_m,
        }
    }

    /// Returns true if `body` touches no wall during its next step.
    pub(super) fn is_clear(&self, solid: &Solid, body: &RigidBody) -> bool {
        let vector = |of: rapier2d::prelude::Vector| Vector2::new(f64::from(of.x), f64::from(of.y));
        let way = vector(body.linvel()) * STEP_S;
        // The prediction distance of fast bodies is the distance that they move in a step.
        let reach = self.radius_m + self.prediction_m.max(way.norm()) + MARGIN_M;
        let at = vector(body.translation()).into();
        solid.all_near(at, reach, |from_wall| self.stays_clear(from_wall, way))
    }

    /// Returns true if a robot touches no wall when it moves by `way`. `from_wall` is the vector
    /// from the nearest point of the wall to the middle of the robot. Like the engine, this treats
    /// the wall as a plane, which is nearer than the wall.
    fn stays_clear(&self, from_wall: Vector2<f64>, way: Vector2<f64>) -> bool {
        let distance = from_wall.norm();
        let gap = distance - self.radius_m;
        let receded = from_wall.dot(&way) / distance;
        // A distance of 0 makes `receded` NaN, and NaN is not greater than the margin.
        gap > MARGIN_M && gap + LOOKAHEAD_STEPS * receded > MARGIN_M
    }
}

/// Moves a body for one step, with the engine's own formula.
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
    use crate::world::{Cell, Maze};
    use proptest::prelude::*;

    const ROWS: [&str; 5] = ["######", "#S.#.#", "##...#", "#..#G#", "######"];

    /// Returns the distances of all walls closer than `reach` to a point, nearest first, by testing
    /// every wall.
    fn distances(maze: &Maze, x: f64, y: f64, reach: f64) -> Vec<f64> {
        let beyond = |low: f64, at: f64| -> f64 { (low - at).max(at - low - 1.0).max(0.0) };
        let distance = |cell: Cell| {
            let low_y = f64::from(maze.height() - cell.row) - 1.0;
            beyond(f64::from(cell.col), x).hypot(beyond(low_y, y))
        };
        let walls = maze.cells().filter(|&cell| maze.is_wall(cell));
        sorted(walls.map(distance).filter(|&distance| distance < reach))
    }

    /// Sorts in ascending order, and removes values that differ only by rounding.
    fn sorted(numbers: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut numbers: Vec<f64> = numbers.collect();
        numbers.sort_by(f64::total_cmp);
        numbers.dedup_by(|b, a| *b - *a < 1e-9);
        numbers
    }

    fn maze() -> Maze {
        Maze::from_json(format!(r#"{{ "rows": {ROWS:?} }}"#).as_bytes(), "m").unwrap()
    }

    proptest! {
        #[test]
        fn every_wall_within_reach_is_tested(
            x in 0.5..5.5_f64, y in 0.5..4.5_f64, reach in 0.1..0.499_f64,
        ) {
            let expected = distances(&maze(), x, y, reach);
            prop_assume!(expected == distances(&maze(), x, y, reach + 1e-9));
            let mut walls = Vec::new();
            maze().solid().all_near([x, y].into(), reach, |from_wall| {
                walls.push(from_wall.norm());
                true
            });
            let found = sorted(walls.into_iter());
            prop_assert_eq!(found.len(), expected.len(), "{:?} {:?}", found, expected);
            for (found, expected) in found.iter().zip(&expected) {
                prop_assert!((found - expected).abs() < 1e-9, "{} {}", found, expected);
            }
        }
    }

    #[test]
    fn a_robot_at_a_wall_is_clear_of_it_as_long_as_it_does_not_drive_towards_it() {
        let clearance = Clearance::new(0.3, 0.002);
        // Its edge is 2 cm east of a wall.
        let from_wall = Vector2::new(0.32, 0.0);
        let stays_clear = |x, y| clearance.stays_clear(from_wall, Vector2::new(x, y));
        assert!(stays_clear(0.05, 0.0), "away from it");
        assert!(stays_clear(0.0, 0.05), "along it");
        assert!(stays_clear(-0.01, 0.0), "towards it, but stopping short");
        assert!(!stays_clear(-0.02, 0.0), "into it");
        assert!(
            !clearance.stays_clear(Vector2::new(0.3, 0.0), Vector2::new(0.05, 0.0)),
            "in touch"
        );
        assert!(
            !clearance.stays_clear(Vector2::zeros(), Vector2::new(0.05, 0.0)),
            "in the wall"
        );
    }
}
