//! XCS, the accuracy-based learning classifier system.
//!
//! Implemented after M. V. Butz and S. W. Wilson, "An algorithmic description of XCS" (2001).
//! It knows percepts, actions and payoffs, and nothing of the environment: who is credited with
//! what, and when, is the caller's part, which calls, step by step, [`Xcs::form_match_set`],
//! [`Xcs::predict`], [`MatchSet::action_set`], [`Xcs::update`] and [`Xcs::evolve`]. With an
//! adaptive mapping it is XCSAM: see [`Xcs::with_adaptive_mapping`].

#![warn(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

pub mod bounds;
pub mod random;

mod classifier;
mod compaction;
mod condition;
mod deletion;
mod ga;
mod handles;
mod learner;
mod mapping;
mod match_index;
mod params;
mod population;
mod prediction;
mod sets;
mod signal;

pub use classifier::Classifier;
pub use compaction::compact;
pub use condition::{Condition, ConditionError};
pub use handles::ClassifierId;
pub use learner::Xcs;
pub use params::Params;
pub use population::{Population, PopulationError};
pub use prediction::{PredictionArray, PredictionSums};
pub use sets::{ActionSet, MatchSet};
pub use signal::{Action, MAX_ACTIONS, MAX_PERCEPT_BITS, PERCEPT_WORDS, Percept, PerceptError};
