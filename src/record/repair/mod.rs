//! Making a whole recording of what a killed run or a bad disk left.

mod recover;
mod salvage;

pub use recover::recover;
pub use salvage::Recovery;
