//! The representation of conditions: the operations that XCS needs.

use std::fmt;
use std::hash::Hash;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::action::MAX_ACTIONS;
use crate::bounds::OutOfRange;
use crate::condition::Condition;
use crate::match_index::MatchIndex;
use crate::params::Params;
use crate::percept::Percept;
use crate::random::Stream;

/// A kind of condition, with its operators for covering, crossover, mutation and subsumption.
///
/// [`Condition`] (ternary) and [`Intervals`](crate::Intervals) (real-valued) implement it. All other
/// procedures of XCS are the same for every representation. An implementation must draw random
/// numbers from the given stream only, so that the same seed gives the same rules.
pub trait Representation:
    Clone + Eq + Hash + fmt::Debug + fmt::Display + Serialize + DeserializeOwned
{
    /// The type of percepts. Cloning a percept must be cheap.
    type Percept: Clone + PartialEq + fmt::Debug + Serialize + DeserializeOwned;
    /// The index that finds the conditions matching a percept.
    type Index: Index<Self>;
    /// Parameters of the operators that are not in [`Params`].
    type Settings: Clone + PartialEq + fmt::Debug + Default;
    /// The largest number of actions of a learner; at most [`WIDE_ACTIONS`](crate::WIDE_ACTIONS).
    const MAX_ACTIONS: usize;

    /// Checks that each setting is within its range.
    ///
    /// # Errors
    /// Returns the first setting out of its range, with the range.
    fn check(settings: &Self::Settings) -> Result<(), OutOfRange>;

    /// Returns the number of attributes.
    fn width(&self) -> usize;

    /// Returns true if the condition matches a percept of the same width.
    fn matches(&self, percept: &Self::Percept) -> bool;

    /// Creates a condition that matches the percept (covering).
    fn covering(
        percept: &Self::Percept,
        params: &Params,
        settings: &Self::Settings,
        stream: &mut Stream,
    ) -> Self;

    /// Mutates the condition of a child created in the niche of the percept.
    fn mutate(
        &mut self,
        percept: &Self::Percept,
        params: &Params,
        settings: &Self::Settings,
        stream: &mut Stream,
    );

    /// Exchanges the attributes `from..to` with those of `other` (two-point crossover).
    fn exchange(&mut self, other: &mut Self, from: usize, to: usize);

    /// Returns how specific the condition is; 0 for the condition that matches every percept.
    fn specificity(&self) -> f64;

    /// Returns true if this condition matches everything that `other` matches, and more.
    fn is_more_general_than(&self, other: &Self) -> bool;
}

/// An index that finds the conditions of a population matching a percept. Positions are those of
/// the population.
pub trait Index<C>: Clone + fmt::Debug + Default
where
    C: Representation,
{
    /// Adds a condition at the next position. All conditions have the same width.
    fn push(&mut self, condition: &C);

    /// Removes the condition at `position`; the last condition takes its place.
    fn swap_remove(&mut self, position: usize);

    /// Calls `found` with the position of each matching condition, in ascending order.
    fn for_each_match(&self, percept: &C::Percept, found: impl FnMut(usize));
}

impl Representation for Condition {
    type Percept = Percept;
    type Index = MatchIndex;
    type Settings = ();
    const MAX_ACTIONS: usize = MAX_ACTIONS;

    fn check((): &()) -> Result<(), OutOfRange> {
        Ok(())
    }

    fn width(&self) -> usize {
        self.width()
    }

    fn matches(&self, percept: &Percept) -> bool {
        self.matches(percept)
    }

    fn covering(percept: &Percept, params: &Params, (): &(), stream: &mut Stream) -> Self {
        Self::covering(percept, params.dont_care, stream)
    }

    fn mutate(&mut self, percept: &Percept, params: &Params, (): &(), stream: &mut Stream) {
        self.mutate(percept, params.mu, stream);
    }

    fn exchange(&mut self, other: &mut Self, from: usize, to: usize) {
        self.exchange(other, from, to);
    }

    fn specificity(&self) -> f64 {
        self.specificity() as f64
    }

    fn is_more_general_than(&self, other: &Self) -> bool {
        self.is_more_general_than(other)
    }
}
