//! Motion without the engine while no wall is in the way: faster, with the same bits.
//!
//! A free body moves in the engine as in [`coast`]. That holds while each wall within the engine's
//! prediction distance stays out of touch during the whole step, so that its contact gets no impulse,
//! *and* no wall pushed in the engine's last step (the next one would start with that push), with
//! contact recycling, continuous collision detection, the cap on turn rates, gravity and damping off.
//! `tests/world/physics.rs` compares the bits.

use nalgebra::Vector2;
use rapier2d::prelude::{Pose, RigidBody, Rotation};

use super::{SOLVER_ITERATIONS, STEP_S};
use crate::world::{Cell, Maze};

/// The engine pushes back what would touch within its step and one part of it more: at the end of
/// a step it asks whether the next part fits.
const FORESIGHT: f64 = 1.0 + 1.0 / SOLVER_ITERATIONS as f64;

/// Distance in metres beyond the engine's prediction distance: more than any rounding.
const MARGIN_M: f64 = 0.001;

/// Knows which walls the engine looks at, and whether the robot can touch one of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clearance {
    radius_m: f64,
    /// The engine's prediction distance for slow bodies, in metres.
    prediction_m: f64,
}

impl Clearance {
    /// For a robot of `radius_m` in an engine that predicts contacts by `prediction_m`.
    pub(super) fn new(radius_m: f64, prediction_m: f64) -> Self {
        Self {
            radius_m,
            prediction_m,
        }
    }

    /// Does `body` keep off all walls during its next step?
    pub(super) fn is_clear(&self, maze: &Maze, body: &RigidBody) -> bool {
        let vector = |of: rapier2d::prelude::Vector| Vector2::new(f64::from(of.x), f64::from(of.y));
        let way = vector(body.linvel()) * STEP_S;
        // Fast bodies are predicted as far as they move in a step.
        let reach = self.radius_m + self.prediction_m.max(way.norm()) + MARGIN_M;
        // With a longer reach there would be walls on both sides to look at.
        reach < 0.5 * maze.cell_size_m()
            && walls_around(maze, vector(body.translation()), reach)
                .into_iter()
                .flatten()
                .all(|from_wall| self.keeps_off(from_wall, way))
    }

    /// Does a robot whose middle lies at `from_wall`, seen from the nearest point of a wall, keep off
    /// it on its `way`? As the engine, this takes the wall for a plane, which is nearer than the wall.
    fn keeps_off(&self, from_wall: Vector2<f64>, way: Vector2<f64>) -> bool {
        let distance = from_wall.norm();
        let gap = distance - self.radius_m;
        let receded = from_wall.dot(&way) / distance;
        // A distance of 0 makes `receded` no number, and no number is greater than the margin.
        gap > MARGIN_M && gap + FORESIGHT * receded > MARGIN_M
    }
}

/// The walls closer than `reach` (below half a cell) to the point `at`, each as the way from its
/// nearest point to `at`; in metres.
fn walls_around(maze: &Maze, at: Vector2<f64>, reach: f64) -> [Option<Vector2<f64>>; 4] {
    let size_m = maze.cell_size_m();
    let (col, up) = ((at.x / size_m).floor(), (at.y / size_m).floor());
    let row = f64::from(maze.height()) - 1.0 - up;
    let (east, gap_x) = nearer_side(at.x - col * size_m, reach, size_m);
    let (north, gap_y) = nearer_side(at.y - up * size_m, reach, size_m);
    let wall = |east: f64, north: f64| {
        let from_wall = Vector2::new(-east * gap_x, -north * gap_y);
        // Negative numbers become 0 here, which is the border: a wall.
        let (col, row) = ((col + east) as u16, (row - north) as u16);
        let is_near = from_wall.norm_squared() < reach * reach;
        (is_near && maze.is_wall(Cell { col, row })).then_some(from_wall)
    };
    [
        wall(0.0, 0.0),
        wall(east, 0.0),
        wall(0.0, north),
        wall(east, north),
    ]
}

/// The step to the neighbouring cell within `reach` along one axis, and the gap to it, for a point at
/// `offset` in its cell; none and no gap, which is the cell itself, when there is none.
fn nearer_side(offset: f64, reach: f64, size_m: f64) -> (f64, f64) {
    if offset < reach {
        (-1.0, offset)
    } else if size_m - offset < reach {
        (1.0, size_m - offset)
    } else {
        (0.0, 0.0)
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

    /// How far the walls closer than `reach` to a point are, nearest first, by looking at all walls.
    fn distances(maze: &Maze, x: f64, y: f64, reach: f64) -> Vec<f64> {
        let beyond = |low: f64, at: f64| -> f64 { (low - at).max(at - low - 1.0).max(0.0) };
        let distance = |cell: Cell| {
            let low_y = f64::from(maze.height() - cell.row) - 1.0;
            beyond(f64::from(cell.col), x).hypot(beyond(low_y, y))
        };
        let walls = maze.cells().filter(|&cell| maze.is_wall(cell));
        sorted(walls.map(distance).filter(|&distance| distance < reach))
    }

    /// Ascending, without what differs by rounding only.
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
        fn the_neighbourhood_sees_every_wall_within_reach(
            x in 0.5..5.5_f64, y in 0.5..4.5_f64, reach in 0.1..0.499_f64,
        ) {
            let expected = distances(&maze(), x, y, reach);
            prop_assume!(expected == distances(&maze(), x, y, reach + 1e-9));
            let walls = walls_around(&maze(), Vector2::new(x, y), reach);
            let found = sorted(walls.into_iter().flatten().map(|from_wall| from_wall.norm()));
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
        let keeps_off = |x, y| clearance.keeps_off(from_wall, Vector2::new(x, y));
        assert!(keeps_off(0.05, 0.0), "away from it");
        assert!(keeps_off(0.0, 0.05), "along it");
        assert!(keeps_off(-0.01, 0.0), "towards it, but not as far as that");
        assert!(!keeps_off(-0.02, 0.0), "into it");
        assert!(
            !clearance.keeps_off(Vector2::new(0.3, 0.0), Vector2::new(0.05, 0.0)),
            "in touch"
        );
        assert!(
            !clearance.keeps_off(Vector2::zeros(), Vector2::new(0.05, 0.0)),
            "in the wall"
        );
    }
}
