//! Recordings: MCAP files that Foxglove and its open fork Lichtblick replay.
//!
//! A [`Recorder`] observes episodes. It writes one file per episode, and `run.mcap` for the whole
//! run. Every run begins at [`EPOCH_NS`], and its episodes share one time axis; a recording contains no
//! real date. The same run produces the same bytes, so a recording can be verified by repeating the
//! run.

pub mod colours;
pub mod disk;
mod error;
pub mod event;
pub mod fault;
pub mod info;
pub mod layout;
mod mode;
mod read;
pub mod resume_hint;
pub mod topics;
mod write;

pub use error::{Error, ErrorKind, world_for_run};
pub use info::{RecordingKind, RobotShape, RunInfo, RunKind};
pub use mode::{RecordMode, RecordModeError};
pub use read::{check, compare, reader, records};
pub use topics::Topic;
pub use write::{RecordSummary, Recorder, is_ours, rolled};

/// The time at which every run begins in its recordings, in nanoseconds since 1970: 1 January 2000, 0:00
/// UTC. Times in the library are those since the beginning of the run.
pub const EPOCH_NS: u64 = 946_684_800_000_000_000;
