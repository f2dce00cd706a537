//! Reading, checking and comparing recordings.

mod check;
mod compare;
pub(super) mod episodes;
pub mod reader;
pub(crate) mod records;

pub use check::check;
pub use compare::compare;
