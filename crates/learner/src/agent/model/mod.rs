//! Models of what follows an action: counted transitions, rules that generalise them, and a POMDP.

pub(super) mod collision_candidates;
pub(super) mod collision_rules;
mod generalisation;
mod outcomes;
pub mod pomdp;
pub mod power;
pub mod rewards;
pub(super) mod inverse_action_rules;
pub(super) mod slips;
pub(super) mod tally;
pub(super) mod transitions;

pub use generalisation::{CollisionRule, Generalisation, InverseActionRule};
