//! What a wheeled robot senses in a maze of square cells, and what it makes of that.
//!
//! ```text
//! what is true (Moment, Terrain) -> Sensors -> Readings -> Onboard -> pose, cells around
//! ```
//!
//! [`Sensors`] see the truth and tell it with noise. [`Onboard`], the robot's own computer, sees
//! nothing but [`Readings`]: neither walls nor a true pose can be named there. Lengths are in metres of the
//! grid frame (origin in the south-western corner of the grid, x to the east, y to the north), angles in
//! radians, counter-clockwise from east.

mod onboard;
mod params;
mod readings;
mod sensors;
mod whole;

pub use onboard::{Belief, Onboard, Surroundings};
pub use params::{
    BumperParams, EncoderParams, EstimatorParams, FaultParams, GyroParams, LidarParams, Robot,
};
pub use readings::{Readings, Return};
pub use sensors::{Moment, Push, SensorState, Sensors, Streams, Terrain, cast};

/// Duration of a step of the simulation, in seconds.
pub const STEP_S: f64 = 0.05;
