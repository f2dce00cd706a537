//! Sensor readings: the only input of the onboard computer.

use nalgebra::{Isometry2, UnitComplex};

/// The range of a beam that hit something too near to be measured, as in ROS (REP 117).
pub(crate) const TOO_NEAR: f64 = f64::NEG_INFINITY;

/// The measurement of one lidar beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Return {
    /// The beam's number in its turn, from 0.
    pub number: u32,
    /// The moment during the step, 0 to 1.
    pub moment: f64,
    /// The beam's nominal direction, relative to the robot's heading.
    pub bearing: UnitComplex<f64>,
    /// The measured range in metres. Minus infinity when something is nearer than
    /// [`nearest_m`](crate::LidarParams::nearest_m), and `None` when nothing came back.
    pub range_m: Option<f64>,
}

/// The sensor readings of one step.
#[derive(Debug, Clone, Copy)]
pub struct Readings<'a> {
    /// The distances that the left and right wheels rolled, in metres.
    pub rolled_m: [f64; 2],
    /// The turn that the gyro measured, in radians, counter-clockwise; `None` without a gyro.
    pub turned_rad: Option<f64>,
    /// The pose at the end of the step in the grid frame, if another localiser has found it.
    pub told: Option<Isometry2<f64>>,
    /// Whether the front and the rear bumper were hit.
    pub bumped: [bool; 2],
    /// True if the robot is above the marker of a goal.
    pub over_marker: bool,
    /// The beams of the step in chronological order.
    pub beams: &'a [Return],
}
