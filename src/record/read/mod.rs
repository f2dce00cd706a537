//! Reading, checking and comparing recordings.

mod check;
mod compare;
mod facts;
pub mod reader;
pub(crate) mod records;

pub use check::check;
pub use compare::compare;
