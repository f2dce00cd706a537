//! How the robot moves, and how it shall move.

use nalgebra::Isometry2;

/// Where the robot is and how it moves, in truth or as far as it knows; lengths in cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    /// The pose in the world frame.
    pub pose: Isometry2<f64>,
    /// Speed along its heading per second; negative when it drives backward.
    pub forward: f64,
    /// Speed to its left per second.
    pub sideways: f64,
    /// Turn rate in rad/s, counter-clockwise.
    pub turn_radps: f64,
}

/// What the controller wants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Command {
    /// Speed along the heading, cells per second.
    pub forward: f64,
    /// Turn rate in rad/s, counter-clockwise.
    pub turn_radps: f64,
}
