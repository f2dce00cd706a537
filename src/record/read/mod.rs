//! Reading, checking and comparing recordings.

mod check;
mod compare;
pub(super) mod episodes;
pub mod reader;
pub(super) mod records;

pub use check::check;
pub use compare::compare;
