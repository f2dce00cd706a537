//! Drives a robot with a learned policy: messages in, commands out.
//!
//! ```text
//!  Readings ─▶ Watch ─▶ Timeline ─▶ Pilot (onboard computer, controller) ─▶ policy ─▶ command
//!             (faults)  (50 ms steps)         │
//!                                       Localisation (faults)
//! ```
//!
//! [`Driver`] is a state machine without ROS, threads or clocks. The caller provides readings and a
//! steady time. Any [`Fault`] makes the driver command rest in the same step. [`SimulatedRobot`] is
//! the counterpart: the physics arena as a robot that is reached only through messages. The feature
//! `ros2` connects both to ROS 2.
//!
//! The robot moves from cell to cell: it drives, rests for one lidar turn, and decides. Units and
//! frames follow REP 103 and REP 105: metres, radians, seconds; `map`, `odom` and `base_link`.

mod bag;
mod checks;
mod driver;
mod fault;
mod given;
mod localisation;
mod mounting;
mod obstacle;
mod options;
mod readings;
mod reason;
mod setup;
mod simulated;
mod step;
mod timeline;
mod watch;
mod wheels;

pub use bag::{DriveBag, DriveRecording};
#[cfg(feature = "ros2")]
pub(crate) use bag::{drive_messages, messages};
pub use checks::Frames;
pub use driver::Driver;
pub use fault::{Fault, Mislocalised};
pub use given::PoseSource;
pub use options::{DriverOptions, NodeOptions, SimulateOptions};
pub use readings::{Imu, JointAngles, Network, Odometry, Readings, Scan, Transform};
pub use setup::{DriveOptions, DriveSetup};
pub use simulated::{SimulatedReadings, SimulatedRobot};
pub use step::{Belief, Decision, DriverStep, Phase};
pub use wheels::Wheels;
