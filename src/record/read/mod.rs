//! Reading recordings: what is in them, whether it is whole, and whether two are the same.

mod check;
mod compare;
pub(super) mod parse;
pub mod reader;

pub use check::{Finding, FindingKind, check};
pub use compare::{Difference, compare};
