//! Writing of recordings while episodes run.

pub(super) mod log_file;
pub(super) mod outbox;
mod recorder;
pub(super) mod event_logger;
pub(super) mod sink;
mod target;
mod odometry;
mod trajectory;

pub(crate) use odometry::rolled;
pub use recorder::{RecordSummary, Recorder};
pub use sink::is_ours;
