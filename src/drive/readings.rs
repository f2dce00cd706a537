//! What a robot reports: the fields of its ROS 2 messages that the driver uses, in metres, radians and seconds (REP 103).

use nalgebra::Isometry2;

use crate::arena::Speeds;

/// A turn of the lidar (`sensor_msgs/msg/LaserScan`).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scan {
    /// When the first beam was sent, in nanoseconds of the robot's clock.
    pub stamp_ns: u64,
    /// The frame of the lidar.
    pub frame: String,
    /// The direction of the first beam, counter-clockwise from the x axis of the lidar's frame.
    pub angle_min_rad: f64,
    /// From one beam to the next.
    pub angle_increment_rad: f64,
    /// From one beam to the next; 0 if all are measured at once.
    pub time_increment_s: f64,
    /// The shortest range that is measured.
    pub range_min_m: f64,
    /// The longest range that is measured.
    pub range_max_m: f64,
    /// The ranges. By REP 117 infinity means that nothing came back, minus infinity that something is too near, and NaN that
    /// there is no measurement.
    pub ranges_m: Vec<f64>,
}

/// Dead reckoning (`nav_msgs/msg/Odometry`).
#[derive(Debug, Clone, PartialEq)]
pub struct Odometry {
    /// When, in nanoseconds of the robot's clock.
    pub stamp_ns: u64,
    /// The frame of the pose, where dead reckoning began.
    pub frame: String,
    /// The frame of the robot, and of its speeds.
    pub child_frame: String,
    /// The robot in `frame`.
    pub pose: Isometry2<f64>,
    /// How it moves.
    pub speeds: Speeds,
}

/// A gyro (`sensor_msgs/msg/Imu`).
#[derive(Debug, Clone, PartialEq)]
pub struct Imu {
    /// When, in nanoseconds of the robot's clock.
    pub stamp_ns: u64,
    /// Turn rate about the vertical axis, counter-clockwise.
    pub turn_radps: f64,
}

/// What the network shows beside the messages.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Network {
    /// Publishers on `/cmd_vel` other than this driver.
    pub other_publishers: usize,
    /// Topics with a peer that cannot be heard or cannot hear: the name, and why.
    pub incompatible: Vec<(String, String)>,
}

/// What arrived since the last step, oldest first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Readings {
    /// Turns of the lidar.
    pub scans: Vec<Scan>,
    /// Dead reckoning.
    pub odometry: Vec<Odometry>,
    /// The gyro.
    pub imu: Vec<Imu>,
    /// The last message on `/clock`, for a robot in simulated time; `None` where the clock is that of this machine.
    pub clock_ns: Option<u64>,
    /// The state of the network.
    pub network: Network,
}
