//! Examples for rules: simulated episodes on the map, and contexts met while driving.
//!
//! Costs are aggregated by context, and each aggregate makes a labelled example: a context and its
//! best actions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::state_map::Map;
use crate::agent::estimator::map::tracker::{Felt, Tracker};
use crate::agent::model::pomdp::GOAL;
use crate::agent::planner::rtdp_bel::{Costs, moved};
use xcs::random::Stream;
use xcs::{Action, ByAction, LabelledExample, Percept};

/// The aggregate of a context: how often it was met, and the summed costs of each action.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Example {
    /// How often the context was met.
    pub weight: f64,
    costs: ByAction<f64>,
}

impl Example {
    /// Adds one more occurrence of the context, with the costs of its actions.
    pub fn add(&mut self, costs: &Costs, map: &Map) {
        self.weight += 1.0;
        let sums = self.costs.iter_mut().zip(costs.in_steps(&map.pomdp));
        sums.for_each(|(sum, cost)| *sum += cost);
    }

    /// Returns the sum of both.
    pub fn with(&self, other: &Self) -> Self {
        let mut both = *self;
        both.weight += other.weight;
        let sums = both.costs.iter_mut().zip(other.costs.iter());
        sums.for_each(|(sum, cost)| *sum += cost);
        both
    }

    /// Returns the mean cost of the best action.
    pub fn least(&self, actions: usize) -> f64 {
        let costs = self.costs[..actions].iter();
        costs.copied().fold(f64::INFINITY, f64::min) / self.weight
    }

    /// Returns the labelled example of a context. An action is best if its regret is at most `tolerance`.
    pub fn labelled(&self, context: Percept, actions: usize, tolerance: f64) -> LabelledExample {
        let mut best = ByAction::default();
        for action in Action::all(actions) {
            best[action.index()] = self.regret(action, actions) <= tolerance;
        }
        LabelledExample {
            percept: context,
            best,
            value: -self.least(actions),
        }
    }

    /// Returns how much more an action costs than the best, on average.
    pub fn regret(&self, action: Action, actions: usize) -> f64 {
        self.costs[action.index()] / self.weight - self.least(actions)
    }
}

/// A robot in a simulated episode.
pub struct Walker {
    /// Its state on the map.
    pub state: u32,
    /// Its state estimate.
    pub tracker: Tracker,
}

impl Walker {
    /// Takes an action, and returns true if it leads to the goal.
    pub fn arrives(&mut self, map: &Map, action: Action, stream: &mut Stream) -> bool {
        let before = self.state;
        self.state = moved(&map.pomdp, before, action, stream);
        if self.state == GOAL {
            return true;
        }
        let felt = Felt {
            bumped: before == self.state,
            rewarded: map.pays(before, self.state),
        };
        self.tracker.act(action, felt);
        false
    }
}

/// Examples by context, in order.
pub type Examples = BTreeMap<Percept, Example>;
