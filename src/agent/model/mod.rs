//! What is foreseen: remembered transitions, rules that foretell, and plans made of them.

mod foresight;
pub(super) mod planner;
pub mod pomdp;
pub(super) mod transitions;

pub use foresight::{CollisionRule, Foresight, ReturnRule};
