//! The highlights of a run: its turning points and a drive of what was learned, in one recording of
//! less than two minutes, on a clock of its own. And the highlights of two runs, side by side.

mod segment;
mod comparison;
mod retime;
mod builder;

pub use builder::HighlightsBuilder;
pub use comparison::{Comparison, compare_highlights};
pub(super) use retime::decoded;
pub use segment::{Segment, segments};
