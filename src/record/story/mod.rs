//! The story of a run: its turning points and a drive of what was learned, in one recording of
//! less than two minutes, on a clock of its own. And the stories of two runs, side by side.

mod chapter;
mod comparison;
mod retime;
mod teller;

pub use chapter::{Chapter, chapters};
pub use comparison::{Comparison, compare_stories};
pub(super) use retime::decoded;
pub use teller::Teller;
