//! How the robot moves, and how it shall move.

use nalgebra::Isometry2;

/// Where the robot is and how it moves, in truth or as far as it knows; lengths in
/// metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    /// The pose in the grid frame.
    pub pose: Isometry2<f64>,
    /// Speed along its heading in m/s; negative when it drives backward.
    pub forward_mps: f64,
    /// Speed to its left in m/s.
    pub sideways_mps: f64,
    /// Turn rate in rad/s, counter-clockwise.
    pub turn_radps: f64,
}

/// What the controller wants.
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
