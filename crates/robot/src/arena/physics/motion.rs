//! Actual and commanded motion of the robot.

use nalgebra::Isometry2;

/// The true or estimated motion of the robot; lengths in metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    /// The pose in the grid frame.
    pub pose: Isometry2<f64>,
    /// Speed along the heading in m/s; negative when driving backward.
    pub forward_mps: f64,
    /// Speed to the left in m/s.
    pub sideways_mps: f64,
    /// Turn rate in rad/s, counter-clockwise.
    pub turn_radps: f64,
}

/// The motion that the controller asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Command {
    /// Speed along the heading in m/s.
    pub forward_mps: f64,
    /// Turn rate in rad/s, counter-clockwise.
    pub turn_radps: f64,
}

impl Command {
    /// Stand still.
    pub const REST: Self = Self {
        forward_mps: 0.0,
        turn_radps: 0.0,
    };
}
