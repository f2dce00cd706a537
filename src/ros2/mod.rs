//! ROS 2 without a ROS installation: the driver and the simulated robot as nodes (feature `ros2`).
//!
//! The nodes use DDS in pure Rust. All decisions are made in [`crate::drive`]. This module contains
//! the topics, their quality of service, and the loops that move messages.

mod covariance;
mod diagnostics;
mod drive_node;
mod latency;
mod link;
mod robot_node;
mod velocity;

pub use drive_node::{DriveReport, DriveSummary, drive};
pub use latency::Latency;
pub use robot_node::simulate;
