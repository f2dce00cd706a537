//! Motion without the engine while no wall is near: faster, with the same bits.
//!
//! A free body moves in the engine as in [`coast`]. That holds while no wall is within the
//! engine's prediction distance *and* the last real step left no active contact (otherwise the
//! engine never learns that the contact has ended), with contact recycling, continuous collision
//! detection, gravity and damping off. `tests/physics.rs` compares the bits.

use rapier2d::prelude::{Pose, RigidBody, Rotation};

use super::{SOLVER_ITERATIONS, STEP_S};
use crate::world::{Cell, Maze};

/// Beyond the engine's prediction distance, in cells: more than any rounding.
const MARGIN: f64 = 0.001;

/// Knows how close to walls the engine must be asked.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clearance {
    reach: f64,
}

impl Clearance {
    /// For a robot of `radius` and an engine that predicts contacts by `prediction`, in cells.
    pub(super) fn new(radius: f64, prediction: f64) -> Self {
        Self {
            reach: radius + prediction + MARGIN,
        }
    }

    /// Are all walls out of reach of a robot at `x`, `y` (in cells of the world frame)?
    pub(super) fn is_clear(&self, maze: &Maze, x: f64, y: f64) -> bool {
        let (col, west) = (x.floor(), x - x.floor());
        let south_row = y.floor();
        let south = y - south_row;
        let row = f64::from(maze.height()) - 1.0 - south_row;
        let (east_step, gap_x) = self.nearer_side(west);
        let (north_step, gap_y) = self.nearer_side(south);
        let wall = |east: f64, north: f64| {
            // Negative numbers become 0 here, which is the border: a wall.
            let (col, row) = ((col + east) as u16, (row - north) as u16);
            maze.is_wall(Cell { col, row })
        };
        let corner = gap_x * gap_x + gap_y * gap_y < self.reach * self.reach;
        !(wall(0.0, 0.0)
            || wall(east_step, 0.0)
            || wall(0.0, north_step)
            || corner && wall(east_step, north_step))
    }

    /// The step to the neighbouring cell within reach along one axis (0 when there is none),
    /// and the gap to it, for a robot at `offset` in its cell.
    fn nearer_side(&self, offset: f64) -> (f64, f64) {
        if offset < self.reach {
            (-1.0, offset)
        } else if 1.0 - offset < self.reach {
            (1.0, 1.0 - offset)
        } else {
            (0.0, f64::INFINITY)
        }
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
