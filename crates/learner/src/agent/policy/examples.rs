//! What rules are to be learned from: imagined episodes on the map, and what they met when they drove.
//!
//! What was met makes a case for each context, and cases make examples: this context, these actions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::hypothesis::is_count;
use crate::agent::estimator::map::state_map::Map;
use crate::agent::estimator::map::tracker::{Felt, Tracker};
use crate::agent::model::pomdp::GOAL;
use crate::agent::planner::rtdp_bel::{BeliefPlanner, Costs, moved};
use xcs::random::Stream;
use xcs::{Action, ByAction, LabelledExample, LabelledExamples, Percept};

/// The most steps of an imagined episode.
pub const MOST_STEPS: u32 = 100;

/// What is known of a context: how often it came, and what each action cost there, added up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Example {
    /// How often it came.
    pub weight: f64,
    costs: ByAction<f64>,
}

impl Example {
    /// Can a case look like this?
    pub fn is_sound(&self) -> bool {
        self.weight >= 1.0 && is_count(&self.weight) && !self.costs.iter().any(|cost| cost.is_nan())
    }

    /// Adds that the context came once more, and what actions cost.
    pub fn add(&mut self, costs: &Costs, map: &Map) {
        self.weight += 1.0;
        let sums = self.costs.iter_mut().zip(costs.in_steps(&map.pomdp));
        sums.for_each(|(sum, cost)| *sum += cost);
    }

    /// Both together.
    pub fn with(&self, other: &Self) -> Self {
        let mut both = *self;
        both.weight += other.weight;
        let sums = both.costs.iter_mut().zip(other.costs.iter());
        sums.for_each(|(sum, cost)| *sum += cost);
        both
    }

    /// The mean cost of the best action.
    pub fn least(&self, actions: usize) -> f64 {
        let costs = self.costs[..actions].iter();
        costs.copied().fold(f64::INFINITY, f64::min) / self.weight
    }

    /// How much more an action costs than the best.
    pub fn regret(&self, action: Action, actions: usize) -> f64 {
        self.costs[action.index()] / self.weight - self.least(actions)
    }
}

/// A robot in an imagined episode: where it is, and what it remembers.
pub struct Walker {
    /// Its state on the map.
    pub state: u32,
    /// What it remembers and believes.
    pub tracker: Tracker,
}

impl Walker {
    /// Acts, and tells whether that leads to the goal.
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

/// The examples of cases that came at least `least_often`, the most frequent first: best are the actions
/// that cost at most `tolerance` more than the best.
pub fn labelled_examples(
    cases: &Examples,
    actions: usize,
    tolerance: f64,
    least_often: f64,
) -> LabelledExamples {
    let mut often: Vec<_> = cases.iter().collect();
    often.retain(|(_, case)| case.weight >= least_often);
    often.sort_by(|a, b| b.1.weight.total_cmp(&a.1.weight));
    let mut labelled_examples = LabelledExamples::default();
    for (number, (context, case)) in often.into_iter().enumerate() {
        let mut best = ByAction::default();
        for action in Action::all(actions) {
            best[action.index()] = case.regret(action, actions) <= tolerance;
        }
        let labelled_example = LabelledExample {
            percept: *context,
            best,
            value: -case.least(actions),
        };
        labelled_examples.give(number, labelled_example);
    }
    labelled_examples
}

/// Imagines episodes from the given states, acting as `choose` says in a context (or as planned,
/// where that says nothing), and adds what it met to the cases. Where moves are exact, what was met is planned for until that
/// changes nothing any more: rules that err lead to where no plan has been.
pub fn imagine(
    map: &Map,
    planner: &mut BeliefPlanner,
    starts: impl Iterator<Item = u32>,
    choose: impl Fn(&Percept, &mut Stream) -> Option<Action>,
    look: impl Fn(Percept) -> Percept,
    stream: &mut Stream,
    cases: &mut Examples,
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
            cases.entry(context).or_default().add(&costs, map);
            let action = choose(&context, stream).unwrap_or_else(|| costs.best());
            if walker.arrives(map, action, stream) {
                break;
            }
        }
    }
}
