//! Mazes in which a robot can act.
//!
//! An [`Arena`] reports facts: the robot moved, collided or reached the goal. The learner decides
//! what each fact is worth. Two arenas exist: in [`GridArena`] a move is a step from cell to cell,
//! and in [`PhysicsArena`] a differential-drive robot drives from cell to cell.

mod disturbed;
mod grid;
mod kind;
mod physics;
mod sensed;

use nalgebra::{Isometry2, Point2, Vector2};

pub use disturbed::{ArenaParams, Disturbances, DisturbedArena};
pub use grid::GridArena;
pub use kind::ArenaKind;
pub use physics::check_fit;
pub use physics::{
    Agreement, BumperParams, CautiousDriving, CautiousParams, EncoderParams, EstimatorParams,
    FaultParams, GyroParams, LidarParams, Localisation, Measured, Now, PhysicsArena, PhysicsError,
    PhysicsParams, Pilot, Robot, Speeds, WheelDrive, beam_tolerance_m, rolled_by,
};
pub use sensed::{Beam, Estimate, LocalMap, Sensed};

use crate::world::{Cell, Maze};
use xcs::{Action, Percept};
pub use xcscr_sensing::{Obstacles, Surroundings};

/// The outcome of an action.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// The robot is in the intended cell.
    Moved,
    /// A wall blocked the way; the robot is back where it was.
    Collided {
        /// The impulse of the collision in newton-seconds; `None` in arenas without mass.
        impulse_n_s: Option<f64>,
    },
    /// The action timed out; the robot may have stopped anywhere.
    Stalled,
    /// The robot is in a goal cell; the episode is over.
    ReachedGoal,
}

/// The robot's state at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Simulation time since the trial began, in nanoseconds.
    pub time_ns: u64,
    /// The robot's pose in the map frame; metres, heading measured from the x axis.
    pub robot_in_map: Isometry2<f64>,
    /// Distances that the left and right wheels have rolled since the reset, in metres.
    pub wheel_travel_m: [f64; 2],
}

/// A collision with a wall, as it is recorded and drawn. [`Outcome::Collided`] does not follow from it, but from the
/// bumpers, or from the true pushes if the pose is looked up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Simulation time since the trial began, in nanoseconds.
    pub time_ns: u64,
    /// The point of contact in the map frame, in metres.
    pub point_in_map: Point2<f64>,
    /// Unit vector from the robot into the wall, in the map frame.
    pub normal_in_map: Vector2<f64>,
    /// The impulse of the collision in newton-seconds.
    pub impulse_n_s: f64,
}

/// The observable state of an arena after a reset or an action.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The maze.
    pub maze: &'a Maze,
    /// The robot's estimated cell.
    pub cell: Cell,
    /// The robot's path during the last reset or action, oldest first; never empty.
    pub trace: &'a [Sample],
    /// The collisions during the last action, oldest first.
    pub contacts: &'a [Contact],
    /// Sensor readings and estimates of a robot that localises itself; `None` if it gets the true
    /// pose.
    pub sensed: Option<Sensed<'a>>,
    /// The action executed last, which may differ from the chosen one. `None` after a reset, and
    /// where actions do not slip.
    pub executed: Option<Action>,
    /// The inverted bits of the percept; `None` in arenas without observation noise.
    pub flipped: Option<Percept>,
    /// The commanded speeds of the left and right rim in the last step, in m/s. `None` where a
    /// controller drives the wheels.
    pub wheels_mps: Option<[f64; 2]>,
}

impl View<'_> {
    /// Returns the robot's current state.
    pub fn now(&self) -> Sample {
        *self.trace.last().expect("a trace is never empty")
    }

    /// Returns the total impulse of the collisions in newton-seconds; 0 for none.
    pub fn impulse_n_s(&self) -> f64 {
        let impulses = self.contacts.iter().map(|contact| contact.impulse_n_s);
        // The sum of no numbers is minus zero.
        impulses.fold(0.0, |total, one| total + one)
    }
}

/// Returns the cell where the robot of a new arena is.
fn first_cell(maze: &Maze) -> Cell {
    maze.starts().next().unwrap_or(maze.goals()[0])
}

/// A maze with a robot in it. The clock keeps running across all episodes of a trial.
pub trait Arena: Send {
    /// Puts the robot at rest in the middle of `start`, a free cell.
    fn reset(&mut self, start: Cell);

    /// Tries to move one cell in the direction of `action`.
    fn act(&mut self, action: Action) -> Outcome;

    /// Returns the current observable state.
    fn view(&self) -> View<'_>;

    /// Sets the clock to nanoseconds since the trial began; a reset must follow.
    fn set_clock(&mut self, time_ns: u64);

    /// Restarts the clock and all random numbers. The arena is then equal to a new one with this seed.
    fn reseed(&mut self, seed: u64);
}
