//! What sensors tell: the only thing that the robot's own computer knows of the world.

use nalgebra::UnitComplex;

/// The range of a beam that hit something too near to be measured, as ROS has it (REP 117).
pub(crate) const TOO_NEAR: f64 = f64::NEG_INFINITY;

/// What came back of one beam of the lidar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Return {
    /// The beam's number in its turn, from 0.
    pub number: u32,
    /// When during the step, 0 to 1.
    pub moment: f64,
    /// The beam's nominal direction, counted from the robot's heading.
    pub bearing: UnitComplex<f64>,
    /// The measured range in metres; minus infinity when something is nearer than
    /// [`nearest_m`](crate::LidarParams::nearest_m), and `None` when nothing came back.
    pub range_m: Option<f64>,
}

/// What the sensors tell about one step.
#[derive(Debug, Clone, Copy)]
pub struct Readings<'a> {
    /// How far the left and the right wheel rolled, in metres.
    pub rolled_m: [f64; 2],
    /// How far the gyro turned, in radians, counter-clockwise; `None` without a gyro.
    pub turned_rad: Option<f64>,
    /// Were the front and the rear bumper hit?
    pub bumped: [bool; 2],
    /// Does the robot stand over the marker of a goal?
    pub over_marker: bool,
    /// The beams of the step in the order of time.
    pub beams: &'a [Return],
}
