//! The maze as a physics simulation: a two-wheeled robot drives from cell to cell.
//!
//! ```text
//! Pilot::begin(direction) ─▶ Speeds ─▶ Robot::step ─▶ Measured ─▶ Pilot::step ─▶ Speeds ...
//! ```
//! A [`Robot`] is body, wheels, floor and sensors. A [`Pilot`] localises the robot and drives it. An
//! action is one bounded manoeuvre (`controller`): the robot turns, then drives one cell. When it
//! hits a wall, it backs off to where it came from. The wheels push with the force that the floor's
//! friction allows (`wheels`). The engine rapier2d simulates the rest (`simulation`) at 20 steps per
//! second. Steps that touch no wall are integrated in closed form (`shortcut`). Outside of the arena
//! the same robot is driven by wheel speeds ([`WheelDrive`]) or over a network, and the same pilot
//! drives a real robot.
//!
//! The robot is localised in one of two ways ([`Localisation`]). *Estimated*: the pilot has only the
//! sensor readings. Sensors, estimator and local map are in the crate `xcscr-sensing`. Neither that
//! crate nor `controller` can access the maze or the true pose. *Ground truth*: for percepts looked
//! up in the maze, the pilot gets the true pose with some noise (`noise`), and `discretiser` looks
//! up the cell.
//!
//! All lengths are in metres and all speeds in m/s, whatever the size of a cell. Inside this folder
//! all poses are in the grid frame: origin in the south-western corner of the grid, x to the east,
//! y to the north. The trait [`Arena`] reports poses in the map frame.

mod agreement;
mod cautious;
mod contact;
mod controller;
mod discretiser;
mod error;
mod fit;
mod motion;
mod noise;
mod params;
mod pilot;
mod records;
mod robot;
mod shortcut;
mod simulation;
mod terrain;
#[cfg(test)]
mod tests;
mod wheel_drive;
mod wheels;

use nalgebra::{Isometry2, Vector2};

pub use agreement::{Agreement, beam_tolerance_m};
pub use cautious::{CautiousDriving, CautiousParams};
pub use error::PhysicsError;
pub use fit::check_fit;
pub use motion::{Now, Speeds};
pub use params::{Localisation, PhysicsParams};
pub use pilot::Pilot;
pub use robot::{Measured, Robot};
pub use wheel_drive::WheelDrive;
pub use wheels::rolled_by;
pub use xcscr_sensing::{
    BumperParams, EncoderParams, EstimatorParams, FaultParams, GyroParams, LidarParams,
};

use self::discretiser::cell_from_position;
use self::records::Records;
use super::{Arena, Outcome, View, first_cell};
use crate::world::{Block, Cell, Direction, Maze, Moves};
use xcs::Action;
use xcscr_sensing::{PUT_DOWN, STEP_S};

/// Solver iterations per step; each is a substep of the motion.
const SOLVER_ITERATIONS: usize = 2;
/// The largest number of wall blocks; the engine needs about a kilobyte for each.
const MAX_BLOCKS: usize = 262_144;
/// The longest side of a world in metres. At this distance the engine's single precision resolves a
/// quarter of a millimetre.
const MAX_EXTENT_M: f64 = 4096.0;

/// A robot that drives from cell to cell, simulated at 20 Hz: a [`Robot`] and its [`Pilot`]. The same
/// maze, settings and noise give bit-identical results.
pub struct PhysicsArena {
    robot: Robot,
    pilot: Pilot,
    cell: Cell,
    /// The number of the episode, from 1; 0 before the first one.
    episode: u32,
    records: Records,
}

impl PhysicsArena {
    /// Creates an arena with the robot in the first start cell. All noise follows from `seed`.
    ///
    /// # Errors
    /// Those of [`Robot::new`].
    pub fn new(maze: Maze, params: PhysicsParams, seed: u64) -> Result<Self, PhysicsError> {
        let robot = Robot::new(maze, params, seed)?;
        let cell = first_cell(robot.maze());
        let mut arena = Self {
            pilot: Pilot::new(robot.params(), robot.maze()),
            robot,
            cell,
            episode: 0,
            records: Records::default(),
        };
        arena.put_down(cell);
        Ok(arena)
    }

    /// Puts the robot down in the middle of a cell, and lets it look round.
    fn put_down(&mut self, start: Cell) {
        let pose = Isometry2::from(self.robot.maze().centre_in_grid(start).coords);
        self.robot.put_down(pose, self.episode);
        self.cell = start;
        let (at, time_ns) = (self.robot.pose(), self.robot.time_ns());
        self.pilot.put_down(at, PUT_DOWN, time_ns);
        self.records.begin(&self.pilot, self.robot.maze());
        while !self.pilot.has_seen() {
            self.pilot.sense(&self.robot.wait());
            self.records.add(&self.pilot, &self.robot);
        }
    }

    /// Sets the cell to the estimated one. An estimate outside the free cells leaves the last cell.
    fn update_cell(&mut self) {
        let position_m = self.pilot.estimate().0.translation.vector.into();
        self.cell = cell_from_position(self.robot.maze(), position_m, self.cell);
    }

    /// Returns true if the robot has found a goal: by the marker on the floor, or by its cell.
    fn is_at_goal(&self) -> bool {
        match self.pilot.onboard() {
            Some(onboard) => onboard.over_marker(),
            None => self.robot.maze().is_goal(self.cell),
        }
    }
}

impl Arena for PhysicsArena {
    fn reset(&mut self, start: Cell) {
        self.episode = self.episode.saturating_add(1);
        self.put_down(start);
    }

    fn act(&mut self, action: Action) -> Outcome {
        self.robot.begin_trace();
        self.robot.begin_action();
        let direction = self.robot.maze().direction(action);
        let begin = |direction| self.pilot.begin(direction, self.pilot.now());
        let mut command = direction.and_then(begin);
        self.records.begin(&self.pilot, self.robot.maze());
        while let Some(speeds) = command {
            self.robot.accelerate_gently(self.pilot.slips());
            command = self.pilot.step(&self.robot.step(speeds));
            self.records.add(&self.pilot, &self.robot);
        }
        self.update_cell();
        let along = self.pilot.along();
        match self.pilot.end(self.is_at_goal()) {
            Outcome::Collided { .. } => Outcome::Collided {
                impulse_n_s: Some(self.robot.frontal_impulse_n_s(-along)),
            },
            other => other,
        }
    }

    fn view(&self) -> View<'_> {
        View {
            sensed: self.records.sensed(&self.pilot, &self.robot),
            ..self.robot.view(self.cell)
        }
    }

    fn set_clock(&mut self, time_ns: u64) {
        self.robot.set_clock(time_ns);
    }

    fn reseed(&mut self, seed: u64) {
        self.robot.reseed(seed);
        self.pilot = Pilot::new(self.robot.params(), self.robot.maze());
        self.reset(first_cell(self.robot.maze()));
    }
}

/// Returns the blocks that make up the walls, or an error for worlds that cannot be simulated.
fn blocks(maze: &Maze) -> Result<Vec<Block>, PhysicsError> {
    let world = || maze.name().to_owned();
    if maze.wraps() {
        return Err(PhysicsError::JoinedEdges { world: world() });
    }
    if maze.moves() == Moves::Eight {
        return Err(PhysicsError::EightMoves { world: world() });
    }
    let extent_m = f64::from(maze.width().max(maze.height())) * maze.cell_size_m();
    if extent_m > MAX_EXTENT_M {
        return Err(PhysicsError::TooWide {
            world: world(),
            extent_m,
            limit_m: MAX_EXTENT_M,
        });
    }
    let blocks = maze.everything_solid().blocks();
    if blocks.len() > MAX_BLOCKS {
        return Err(PhysicsError::TooManyWalls {
            world: world(),
            count: blocks.len(),
            limit: MAX_BLOCKS,
        });
    }
    Ok(blocks)
}

/// Returns the unit vector of one of the main directions.
fn vector(direction: Direction) -> Vector2<f64> {
    let (east, south) = direction.offset();
    Vector2::new(f64::from(east), f64::from(-south))
}

/// Returns the length of a move, and the distance from its end within which no wall stops it, in
/// metres. In a maze the robot that has left its cell can reach the next one. In a world from a map
/// something may be anywhere on the way.
fn lengths_m(maze: &Maze, params: &PhysicsParams) -> [f64; 2] {
    let size_m = maze.cell_size_m();
    let settled_m = match maze.is_from_map() {
        true => params.arrival_m,
        false => 0.5 * size_m,
    };
    [size_m, settled_m]
}
