//! Writing recordings, while episodes are run.

pub mod layout;
pub(super) mod log_file;
mod mode;
pub(super) mod outbox;
mod rebuild;
mod recorder;
pub(super) mod scribe;

pub use mode::{RecordMode, RecordModeError};
pub use outbox::Tap;
pub use recorder::{RecordSummary, Recorder, RecorderMemory};
