//! Writing of recordings while episodes run.
//!
//! ```text
//! Observer ─▶ Recorder ─▶ EventSource ─▶ events ─▶ MessageStream (facts and scenes) ─▶ File (MCAP)
//! ```

mod event_source;
mod file;
mod odometry;
mod recorder;
mod stream;
mod target;
mod trajectory;

pub use file::is_ours;
pub use odometry::rolled;
pub use recorder::{RecordSummary, Recorder};
