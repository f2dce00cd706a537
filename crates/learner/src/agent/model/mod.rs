//! Models of what follows an action: counted transitions, and rules that generalise them.

pub(super) mod collision_candidates;
pub(super) mod collision_rules;
mod generalisation;
mod outcomes;
mod power;
pub(super) mod inverse_action_rules;
pub(super) mod slips;
pub(super) mod tally;
pub(super) mod transitions;

pub use generalisation::{CollisionRule, Generalisation, InverseActionRule};
