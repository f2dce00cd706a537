//! Recordings of drives, in the format of `ros2 bag`: MCAP files with ROS 2 messages in CDR.

pub(crate) mod drive_messages;
mod file;
pub(crate) mod messages;
mod topics;
mod transforms;
mod writer;

pub use file::{DriveBag, DriveRecording};
