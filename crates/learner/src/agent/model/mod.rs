//! What is foreseen: remembered transitions, rules that foretell, and plans made of them.

pub(super) mod bumps;
pub(super) mod collision_rules;
mod coverage;
pub(super) mod exploration;
mod foresight;
pub(super) mod known;
mod outcomes;
pub mod pomdp;
pub(super) mod return_rules;
mod slips;
pub(super) mod tally;
pub(super) mod transitions;

pub use foresight::{CollisionRule, Foresight, ReturnRule};
