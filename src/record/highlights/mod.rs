//! The highlights recording of a run: its turning points and a drive of the learned policy in less
//! than two minutes, on its own clock. It can also show two runs side by side.

mod builder;
mod comparison;
mod retime;
mod segment;

pub use builder::{HighlightsBuilder, ShownRun};
pub use comparison::{Comparison, compare_highlights};
pub use segment::{Segment, segments};
