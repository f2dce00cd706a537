//! Recordings: MCAP files that Foxglove and its open fork Lichtblick replay.
//!
//! A [`Recorder`] listens to episodes and writes one file for each, and `run.mcap` for the whole
//! run. All times in a file are simulation time; no real date is in it. The same run gives the
//! same bytes, so that a recording can be verified by running it again.

mod byte_range;
mod channels;
mod check;
mod compare;
mod error;
mod info;
pub mod layout;
#[cfg(feature = "live")]
pub mod live;
mod log_file;
mod mode;
mod outbox;
mod parse;
pub mod reader;
mod rebuild;
mod recorder;
mod recover;
mod salvage;
mod scribe;
pub mod server;

pub use channels::Topic;
pub use check::{Finding, FindingKind, check, check_recording};
pub use compare::{Difference, compare};
pub use error::RecordError;
pub use info::{RobotShape, RunInfo};
pub use mode::{RecordMode, RecordModeError};
pub use outbox::Tap;
pub use recorder::{RecordSummary, Recorder, RecorderMemory};
pub use recover::recover;
pub use salvage::Recovery;
