//! A maze one can act in.
//!
//! An [`Arena`] reports facts: it moved, it collided, it reached the goal. What a fact is worth
//! is decided by the learner. Two arenas exist: [`GridArena`], where a move is a step from
//! cell to cell, and [`PhysicsArena`], where a differential-drive robot drives there.

mod auxiliary;
mod grid;
mod kind;
mod noisy_percepts;
mod physics;
mod sensed;
mod slip;

use nalgebra::{Isometry2, Point2, Vector2};
use serde::{Deserialize, Serialize};

pub use auxiliary::RewardingArena;
pub use grid::GridArena;
pub use kind::ArenaKind;
pub use noisy_percepts::NoisyPerceptArena;
pub use physics::check_fit;
pub use physics::{
    BatchArena, BumperParams, Care, CautiousParams, EncoderParams, EstimatorParams, FaultParams,
    GyroParams, Lanes, LidarParams, Localisation, PhysicsArena, PhysicsError, PhysicsParams,
    Snapshot, WheelDrive,
};
pub use sensed::{Beam, Estimate, Sensed};
pub use slip::ArenaParams;
pub use slip::SlippingArena;

use crate::world::{Cell, Maze};
use xcs::random::Stream;
use xcs::{Action, Percept};
pub use xcscr_sensing::Surroundings;

/// What came of an action.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// The robot stands in another cell, as it wanted.
    Moved,
    /// The robot stands in another cell, as it wanted, and for the first time in this episode in one
    /// that pays by itself.
    FoundReward {
        /// What the cell pays (auxiliary reward).
        reward: f64,
    },
    /// A wall was in the way; the robot stands where it was.
    Collided {
        /// The impulse of the hit in newton-seconds; `None` where nothing has mass.
        impulse_ns: Option<f64>,
    },
    /// The robot ran out of time on the way, and stands wherever that was.
    Stalled,
    /// The robot stands in a goal cell; the episode is over.
    ReachedGoal,
}

impl Outcome {
    /// The auxiliary reward that was found; 0 without one.
    pub fn found(self) -> f64 {
        match self {
            Self::FoundReward { reward } => reward,
            Self::Moved | Self::Collided { .. } | Self::Stalled | Self::ReachedGoal => 0.0,
        }
    }
}

/// Where the robot was at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Simulation time since the trial began, in nanoseconds.
    pub time_ns: u64,
    /// The robot's pose in the map frame; metres, heading counted from the x axis.
    pub robot_in_map: Isometry2<f64>,
    /// How far the left and the right wheel have rolled since the reset, in metres.
    pub wheel_travel_m: [f64; 2],
}

/// A hit against a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Simulation time since the trial began, in nanoseconds.
    pub time_ns: u64,
    /// The point of contact in the map frame, in metres.
    pub point_in_map: Point2<f64>,
    /// Unit vector from the robot into the wall, in the map frame.
    pub normal_in_map: Vector2<f64>,
    /// The impulse of the hit in newton-seconds.
    pub impulse_ns: f64,
}

/// What can be seen of an arena after a reset or an action.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The maze.
    pub maze: &'a Maze,
    /// The cell in which the robot believes to stand.
    pub cell: Cell,
    /// The robot's path during the last reset or action, oldest first; never empty.
    pub trace: &'a [Sample],
    /// The hits during the last action, oldest first.
    pub contacts: &'a [Contact],
    /// What the robot sensed, of one that knows only that; `None` of one that is told where it is.
    pub sensed: Option<Sensed<'a>>,
    /// The action that was carried out last, which may be another than the chosen one; `None`
    /// after a reset, and where actions do not slip.
    pub executed: Option<Action>,
    /// The bits of the percept that are perceived as their opposites; `None` where none ever are.
    pub flipped: Option<Percept>,
}

impl View<'_> {
    /// Where and when the robot is now.
    pub fn now(&self) -> Sample {
        *self
            .trace
            .last()
            .expect("a trace holds the pose it ends in")
    }
}

/// What outlasts an episode: everything else a reset makes anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lasting {
    /// Simulation time since the trial began, in nanoseconds.
    pub time_ns: u64,
    /// The noise to come; `None` where there is none.
    pub noise: Option<Stream>,
    /// What sensors and estimator keep; `None` of a robot that is told where it is.
    pub sensing: Option<physics::SensingMemory>,
    /// Which actions will slip; `None` where none do.
    pub slip: Option<Stream>,
    /// Which bits of percepts will flip; `None` where none do.
    pub flips: Option<Stream>,
}

/// A maze with a robot in it. The clock runs on over all episodes of a trial.
pub trait Arena: Send {
    /// Puts the robot at rest into the middle of `start`, a free cell.
    fn reset(&mut self, start: Cell);

    /// Tries to move one cell in the direction of `action`.
    fn act(&mut self, action: Action) -> Outcome;

    /// What can be seen now.
    fn view(&self) -> View<'_>;

    /// What the next reset will not undo.
    fn lasting(&self) -> Lasting;

    /// Continues where another arena of the same maze and settings was; a reset must follow.
    fn continue_from(&mut self, lasting: &Lasting);
}
