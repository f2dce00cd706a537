//! Examples for rules: simulated episodes on the map, and contexts met while driving.
//!
//! Costs are aggregated by context, and each aggregate makes a labelled example: a context and its
//! best actions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::hypothesis::is_count;
use crate::agent::estimator::map::state_map::Map;
use crate::agent::estimator::map::tracker::{Felt, Tracker};
use crate::agent::model::pomdp::GOAL;
use crate::agent::planner::rtdp_bel::{BeliefPlanner, Costs, moved};
use xcs::random::Stream;
use xcs::{Action, ByAction, LabelledExample, LabelledExamples, Percept};

/// The maximum number of steps of a simulated episode.
pub const MOST_STEPS: u32 = 100;

/// The aggregate of a context: how often it was met, and the summed costs of each action.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Example {
    /// How often the context was met.
    pub weight: f64,
    costs: ByAction<f64>,
}

impl Example {
    /// Returns true if the aggregate is valid.
    pub fn is_sound(&self) -> bool {
        self.weight >= 1.0 && is_count(&self.weight) && !self.costs.iter().any(|cost| cost.is_nan())
    }

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

/// Returns the labelled examples of contexts with a weight of at least `least_often`, most frequent first. An action
/// is best if its regret is at most `tolerance`.
pub fn labelled_examples(
    examples: &Examples,
    actions: usize,
    tolerance: f64,
    least_often: f64,
) -> LabelledExamples {
    let mut often: Vec<_> = examples.iter().collect();
    often.retain(|(_, example)| example.weight >= least_often);
    often.sort_by(|a, b| b.1.weight.total_cmp(&a.1.weight));
    let mut labelled_examples = LabelledExamples::default();
    for (number, (context, example)) in often.into_iter().enumerate() {
        let mut best = ByAction::default();
        for action in Action::all(actions) {
            best[action.index()] = example.regret(action, actions) <= tolerance;
        }
        let labelled_example = LabelledExample {
            percept: *context,
            best,
            value: -example.least(actions),
        };
        labelled_examples.give(number, labelled_example);
    }
    labelled_examples
}

/// Simulates episodes from the given states, and adds the contexts met to the examples. The agent acts as `choose`
/// returns, or by the plan if that is `None`. If moves are exact, each belief met is planned until its costs
/// converge: wrong rules lead to beliefs that no plan has visited.
pub fn simulate(
    map: &Map,
    planner: &mut BeliefPlanner,
    starts: impl Iterator<Item = u32>,
    choose: impl Fn(&Percept, &mut Stream) -> Option<Action>,
    look: impl Fn(Percept) -> Percept,
    stream: &mut Stream,
    examples: &mut Examples,
) {
    let mut known = BTreeMap::new();
    for start in starts {
        let mut walker = Walker {
            state: start,
            tracker: Tracker::begun(map.first_belief(start)),
        };
        for _ in 0..MOST_STEPS {
            let Walker { state, tracker } = &mut walker;
            tracker.perceive_rightly(map, map.pomdp.percept(*state));
            let context = look(tracker.context(map));
            let costs = *known
                .entry(tracker.belief().key())
                .or_insert_with(|| planner.settled_costs(&map.pomdp, tracker.belief()));
            examples.entry(context).or_default().add(&costs, map);
            let action = choose(&context, stream).unwrap_or_else(|| costs.best());
            if walker.arrives(map, action, stream) {
                break;
            }
        }
    }
}
