//! Recordings: MCAP files that Foxglove and its open fork Lichtblick replay.
//!
//! A [`Recorder`] observes episodes. It writes one file per episode, and `run.mcap` for the whole
//! run. All times in a file are simulation times; a recording contains no real date. The same run
//! produces the same bytes, so a recording can be verified by repeating the run.

pub(crate) mod error;
mod event;
mod info;
pub mod layout;
mod mode;
pub mod player;
mod read;
pub(crate) mod resume_hint;
mod serve;
mod topics;
mod write;

pub use info::{RecordingKind, RobotShape, RunInfo, RunKind};
pub use mode::RecordMode;
pub(crate) use mode::RecordModeError;
pub(crate) use read::records;
pub use read::{check, compare, reader};
pub use serve::server;
pub use topics::Topic;
pub use write::{RecordSummary, Recorder};
pub(crate) use write::{is_ours, rolled};
