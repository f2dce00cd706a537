//! XCS, the accuracy-based learning classifier system.
//!
//! Implemented after M. V. Butz and S. W. Wilson, "An algorithmic description of XCS" (2001). XCS
//! knows only percepts, actions and rewards. Implement [`Environment`] and let a [`Runner`] learn
//! in it. Episodes of one action are single-step problems. In longer episodes the reward is
//! discounted and propagated back.
//!
//! ```
//! use xcs::{Action, Environment, Params, Percept, Response, Runner};
//!
//! /// Asks whether the number of ones is odd.
//! struct Parity(u64);
//!
//! impl Environment for Parity {
//!     fn actions(&self) -> usize {
//!         2
//!     }
//!
//!     fn begin(&mut self) -> Percept {
//!         self.0 = (self.0 + 3) % 8;
//!         Percept::from_word(self.0, 3)
//!     }
//!
//!     fn act(&mut self, action: Action) -> Response {
//!         let right = action.index() == self.0.count_ones() as usize % 2;
//!         Response { reward: if right { 1000.0 } else { 0.0 }, next: None }
//!     }
//! }
//!
//! let mut runner = Runner::new(Parity(0), Params::default(), 7)?;
//! for _ in 0..2_000 {
//!     runner.learn();
//! }
//! assert!((0..8).all(|_| runner.test().reward == 1000.0));
//! # Ok::<(), xcs::bounds::OutOfRange>(())
//! ```
//!
//! To control credit assignment, call the steps yourself: [`Xcs::form_match_set`],
//! [`Xcs::predict`], [`MatchSet::action_set`], [`Xcs::update`] and [`Xcs::evolve`]. With an
//! adaptive mapping, the learner is XCSAM: see [`Xcs::with_adaptive_mapping`]. [`fewest_rules`]
//! returns the fewest rules that keep all decisions. The examples show the 11-multiplexer, the real-valued 6-multiplexer and a
//! corridor.
//!
//! Conditions are ternary ([`Condition`]), for percepts of up to 320 bits and up to 8 actions. For
//! real-valued percepts there are interval conditions ([`Intervals`], XCSR), with any number of
//! attributes and up to 256 actions; see [`Runner::with_settings`]. Both implement
//! [`Representation`], the type parameter of all types here. [`Agent`] is for callers that carry
//! out the actions themselves.

#![warn(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

pub mod bounds;
pub mod random;

mod action;
mod agent;
mod classifier;
mod condition;
mod deletion;
mod fewest;
mod ga;
mod guided_covering;
mod handles;
mod intervals;
mod layout;
mod learner;
mod labelled_examples;
mod mapping;
mod match_index;
mod params;
mod percept;
mod population;
mod prediction;
mod ranges;
mod representation;
mod runner;
mod sets;
#[cfg(test)]
mod limits;

pub use action::{Action, ByAction, MAX_ACTIONS, WIDE_ACTIONS};
pub use agent::{Agent, AgentState};
pub use classifier::Classifier;
pub use condition::{Condition, ConditionError};
pub use fewest::{fewest_rules, fewest_rules_for};
pub use handles::ClassifierId;
pub use intervals::{
    IntervalError, IntervalIndex, IntervalSettings, Intervals, NotANumber, RealPercept,
};
pub use labelled_examples::{LabelledExample, LabelledExamples};
pub use layout::Layout;
pub use learner::Xcs;
pub use match_index::MatchIndex;
pub use params::{GaClock, Params, RateScope, SubsumerTies, UpdateOrder};
pub use percept::{MAX_PERCEPT_BITS, PERCEPT_WORDS, Percept, PerceptError};
pub use population::{Population, PopulationError};
pub use prediction::{PredictionArray, PredictionSums};
pub use ranges::NumberRange;
pub use representation::{Index, Representation};
pub use runner::{Environment, Episode, Response, Runner};
pub use sets::{ActionSet, MatchSet};

/// Runs the example of the README as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
