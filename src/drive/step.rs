//! The result of a step of the driver.

use nalgebra::{Isometry2, Matrix3};

use super::fault::Fault;
use crate::arena::{Outcome, Speeds};
use crate::world::Cell;
use xcs::{Action, Condition, Percept, PredictionArray};

/// The estimated position of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Belief {
    /// The time of the newest odometry, in nanoseconds of the robot's clock.
    pub stamp_ns: u64,
    /// The pose of the robot in the map frame, in metres.
    pub robot_in_map: Isometry2<f64>,
    /// The covariance of x, y (metres) and heading (radians) in the map frame.
    pub covariance: Matrix3<f64>,
    /// The pose of the odometry frame in the map frame.
    pub odom_in_map: Isometry2<f64>,
    /// The cell; `None` outside of the maze.
    pub cell: Option<Cell>,
    /// True if the driver has estimated the pose; false if another localiser has.
    pub is_own: bool,
}

/// A decision of the policy.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// The number of the decision, from 1.
    pub number: u32,
    /// The time, in nanoseconds of the robot's clock.
    pub stamp_ns: u64,
    /// The estimated cell.
    pub cell: Cell,
    /// The percept.
    pub percept: Percept,
    /// The value of each action.
    pub values: PredictionArray,
    /// The chosen action.
    pub action: Action,
    /// The condition of the rule with the largest weight; `None` if no rule decided.
    pub rule: Option<Condition>,
    /// The decision and its reason as text.
    pub words: String,
}

/// The phase of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, strum::IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub enum Phase {
    /// Waiting for the first scan and odometry.
    Waiting,
    /// At rest for the first lidar turns.
    LookingRound,
    /// Driving to another cell.
    Driving,
    /// At rest, until the onboard computer has processed the readings of the arrival.
    Settling,
    /// In a goal cell. The drive is over.
    AtGoal,
    /// The step threshold is reached. The drive is over.
    OutOfSteps,
}

/// The result of a driver step.
#[derive(Debug, Clone, PartialEq)]
pub struct DriverStep {
    /// The commanded speeds; rest if there is a fault.
    pub command: Speeds,
    /// The current faults; empty if there are none.
    pub faults: Vec<Fault>,
    /// The phase of the drive.
    pub phase: Phase,
    /// The estimated position; `None` before the first readings.
    pub belief: Option<Belief>,
    /// The decision made in this step; `None` in most steps.
    pub decision: Option<Decision>,
    /// The outcome of the last action, if the action ended in this step.
    pub outcome: Option<Outcome>,
}
