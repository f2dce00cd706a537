//! Reading, checking and comparing recordings.

mod check;
mod compare;
pub(super) mod parse;
pub mod reader;

pub use check::{Finding, FindingKind, check};
pub use compare::{Difference, compare};
