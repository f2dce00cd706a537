//! Checks the estimated position against the maze.
//!
//! The filter does not know the walls, so its estimate can be off by a whole cell. The driver knows
//! the maze and compares.

use std::f64::consts::TAU;

use nalgebra::{Isometry2, Matrix3, UnitComplex, Vector2};
use xcscr_sensing::{Return, cast};

use super::fault::Mislocalised;
use crate::arena::beam_tolerance_m;
use crate::world::Maze;

/// The maximum standard deviation of the position, as a share of a cell.
const UNSURE: f64 = 0.25;
/// The number of steps with a larger deviation that is a fault: half a second. Beams that disagree with the
/// walls, as in front of a box, raise the deviation until others agree.
const UNSURE_STEPS: u32 = 10;
/// The share of disagreeing beams that makes a turn bad.
const DISAGREEING: f64 = 0.4;
/// The least number of compared beams of a turn that says anything. In a hall that is larger than the
/// lidar's range, the few echoes may all be outliers.
const LEAST_COMPARED: u32 = 8;
/// The number of consecutive bad turns that is a fault.
const TURNS: u32 = 2;
/// The maximum number of compared beams per turn.
const COMPARED: usize = 64;
/// A lidar sees walls if at least this share of its beams end at one, within this share of its range.
/// The margin is for an estimate that is off, and for walls that reflect little.
const WALLS: f64 = 0.1;
const WELL_IN_RANGE: f64 = 0.8;

/// Returns true if a lidar with this range sees walls from a pose in the grid frame.
pub fn sees_walls(maze: &Maze, pose: &Isometry2<f64>, range_max_m: f64) -> bool {
    let ends_at_wall = |number: &usize| {
        let direction = UnitComplex::new(TAU * *number as f64 / COMPARED as f64) * Vector2::x();
        let from = pose.translation.vector;
        cast(maze, from, direction, WELL_IN_RANGE * range_max_m).is_some()
    };
    (0..COMPARED).filter(ends_at_wall).count() as f64 >= WALLS * COMPARED as f64
}

/// Compares beams with the walls of a maze, one lidar turn at a time.
#[derive(Debug, Clone)]
pub struct Localisation {
    /// Every n-th beam is compared.
    every: usize,
    beams: usize,
    seen: usize,
    compared: u32,
    disagreeing: u32,
    bad_turns: u32,
    unsure_steps: u32,
}

impl Localisation {
    /// Creates a check for a lidar with this number of beams per turn.
    pub fn new(beams: u32) -> Self {
        let beams = beams as usize;
        Self {
            every: beams.div_ceil(COMPARED).max(1),
            beams,
            seen: 0,
            compared: 0,
            disagreeing: 0,
            bad_turns: 0,
            unsure_steps: 0,
        }
    }

    /// Sets the number of beams in the next turns.
    pub fn set_beams(&mut self, beams: usize) {
        self.beams = beams;
    }

    /// Compares the beams of a step of the onboard computer. `pose` is the estimate at the end of
    /// the step in the grid frame, and `moved` the motion during the step.
    pub fn step(
        &mut self,
        maze: &Maze,
        pose: &Isometry2<f64>,
        moved: &Isometry2<f64>,
        beams: &[Return],
        range_max_m: f64,
    ) -> Option<Mislocalised> {
        let before = pose * moved.inverse();
        let turned_rad = moved.rotation.angle();
        let path = pose.translation.vector - before.translation.vector;
        for beam in beams {
            self.seen += 1;
            let Some(range_m) = beam.range_m.filter(|range_m| *range_m > 0.0) else {
                continue;
            };
            if !(beam.number as usize).is_multiple_of(self.every) {
                continue;
            }
            let origin = before.translation.vector + beam.moment * path;
            let heading = before.rotation * UnitComplex::new(beam.moment * turned_rad);
            let direction = (heading * beam.bearing) * Vector2::x();
            let wall_m = cast(maze, origin, direction, range_max_m).unwrap_or(range_max_m);
            self.compared += 1;
            self.disagreeing +=
                u32::from((range_m - wall_m).abs() > beam_tolerance_m(maze, wall_m));
        }
        if self.seen < self.beams {
            return None;
        }
        self.end_turn()
    }

    fn end_turn(&mut self) -> Option<Mislocalised> {
        let share = f64::from(self.disagreeing) / f64::from(self.compared.max(1));
        let is_bad = self.compared >= LEAST_COMPARED && share > DISAGREEING;
        (self.seen, self.compared, self.disagreeing) = (0, 0, 0);
        self.bad_turns = if is_bad { self.bad_turns + 1 } else { 0 };
        (self.bad_turns >= TURNS).then_some(Mislocalised::ScanDisagrees(share))
    }

    /// Checks the estimate of a step on its own: a pose in the grid frame and its covariance.
    pub fn check(
        &mut self,
        maze: &Maze,
        pose: &Isometry2<f64>,
        covariance: &Matrix3<f64>,
    ) -> Option<Mislocalised> {
        let deviation_m = covariance[(0, 0)].max(covariance[(1, 1)]).max(0.0).sqrt();
        self.unsure_steps = if deviation_m > UNSURE * maze.cell_size_m() {
            self.unsure_steps + 1
        } else {
            0
        };
        if self.unsure_steps > UNSURE_STEPS {
            return Some(Mislocalised::Unsure(deviation_m));
        }
        let cell = maze.cell_in_grid(pose.translation.vector.into());
        let is_free = cell.is_some_and(|cell| !maze.is_wall(cell));
        (!is_free).then_some(Mislocalised::InAWall)
    }
}
