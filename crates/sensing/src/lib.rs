#![doc = include_str!("../README.md")]
//! ## Data flow
//!
//! ```text
//! ground truth (Moment, Terrain) -> Sensors -> Readings -> Onboard -> pose, cells around
//! ```
//!
//! [`Sensors`] measure the ground truth with noise. [`Onboard`], the robot's own computer, receives
//! nothing but [`Readings`]: its code cannot access walls or the true pose. Lengths are in metres
//! of the grid frame (origin in the south-western corner of the grid, x to the east, y to the
//! north). Angles are in radians, counter-clockwise from east.

mod onboard;
mod params;
mod readings;
mod sensors;
mod whole;

pub use onboard::{Field, Obstacles, Onboard, PUT_DOWN, Surface, Surroundings};
pub use params::{
    BumperParams, EncoderParams, EstimatorParams, FaultParams, GyroParams, LidarParams, RobotParams,
};
pub use readings::{Readings, Return};
pub use sensors::{Moment, Push, Sensors, Streams, Terrain, cast};

/// Duration of a step, in seconds.
pub const STEP_S: f64 = 0.05;
/// Duration of a step in nanoseconds, as an integer so that clocks never drift.
pub const STEP_NS: u64 = 50_000_000;
