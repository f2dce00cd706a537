//! Recovery of complete recordings from the files of a killed run or a bad disk.

mod recover;
mod records;

pub use records::Recovery;
pub use recover::recover;
