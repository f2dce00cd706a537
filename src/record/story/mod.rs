//! The story of a run: its turning points and a drive of what was learned, in one recording of
//! less than two minutes, on a clock of its own.

mod chapter;
mod retime;
mod teller;

pub use chapter::{Chapter, chapters};
pub use teller::Teller;
