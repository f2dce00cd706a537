//! Where the robot is, and where it estimates that it is, at one moment.

use nalgebra::{Isometry2, Vector2};

use xcscr_robot::arena::Estimate;

/// The pose of the robot at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Simulation time since the trial began, in nanoseconds.
    pub time_ns: u64,
    /// The true pose.
    pub robot_in_map: Isometry2<f64>,
    /// The pose by dead reckoning. The frame `odom` is where the robot was when the episode began.
    pub robot_in_odom: Isometry2<f64>,
    /// The estimate; `None` if the robot is given its true pose.
    pub estimate: Option<Estimate>,
    /// The true velocity in the robot's own frame, in m/s.
    pub velocity_mps: Vector2<f64>,
    /// The true turning speed, in rad/s.
    pub turn_radps: f64,
}

impl Pose {
    /// Returns the pose in the map frame that the robot acts on.
    pub fn assumed_in_map(&self) -> Isometry2<f64> {
        self.estimate
            .map_or(self.robot_in_map, |estimate| estimate.robot_in_map)
    }
}
