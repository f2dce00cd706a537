//! Who is credited, with what, and when.

mod method;

pub use method::{EndCredit, RewardMethod, StepCredit};
