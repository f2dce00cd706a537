//! Reading, checking and comparing recordings.

mod check;
mod compare;
mod facts;
pub mod reader;
pub mod records;

pub use check::check;
pub use compare::compare;
