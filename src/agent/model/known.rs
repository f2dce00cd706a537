//! What is known to be worth how much: values of what was tried, kept up to date step by step.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::transitions::Transitions;
use crate::agent::params::Params;
use xcs::Lesson;
use xcs::{Action, MAX_ACTIONS};

/// Changes of a value by less than this share of it are not passed on.
const NEGLIGIBLE: f64 = 1e-9;
/// Actions whose values differ by less than this share are equally good.
const TIE: f64 = 1e-7;
/// A greater discount would leave values without a floor.
const GREATEST_DISCOUNT: f64 = 0.999_999;
/// Values that are updated at once; what is left waits for the next step.
const MOST_UPDATES: usize = 1_000_000;

/// By percept: the pairs that were followed by it.
pub(in crate::agent) type Before = Vec<Vec<(usize, Action)>>;

/// The value of each percept under the best policy over what was tried, by prioritised sweeping
/// (Moore and Atkeson 1993): a change is passed backward, the greatest values first, and touches
/// only what depends on it.
///
/// Values are counted from that of walking for ever, `step / (1 - gamma)`. So counted, a value is
/// `gamma` to the power of the steps to the goal, times a constant: it stays exact thousands of
/// steps away, and 0 means that no way is known.
#[derive(Debug, Clone)]
pub(in crate::agent) struct Known {
    actions: usize,
    gamma: f64,
    step: f64,
    /// By the number of the percept.
    values: Vec<f64>,
    before: Before,
    /// Percepts whose value is to be updated, the greatest first.
    queue: BinaryHeap<(u64, Reverse<usize>)>,
    /// Percepts of which the lesson may have changed.
    touched: Vec<usize>,
}

impl Known {
    pub fn new(actions: usize, params: &Params) -> Self {
        Self {
            actions,
            gamma: params.gamma.min(GREATEST_DISCOUNT),
            step: params.step,
            values: Vec::new(),
            before: Vec::new(),
            queue: BinaryHeap::new(),
            touched: Vec::new(),
        }
    }

    /// What learning has changed so far: the values, and what came before each percept.
    pub fn kept(&self) -> (&[f64], &Before) {
        (&self.values, &self.before)
    }

    /// Goes on from what was kept; `false` if it is not about the percepts of the memory.
    pub fn resume(&mut self, (values, before): (Vec<f64>, Before), memory: &Transitions) -> bool {
        (self.values, self.before) = (values, before);
        let met = memory.percepts().len();
        let mut pairs = self.before.iter().flatten();
        self.values.len() <= met
            && self.before.len() <= met
            && self
                .values
                .iter()
                .all(|value| value.is_finite() && *value >= 0.0)
            && pairs.all(|&(percept, action)| percept < met && action.index() < self.actions)
    }

    /// The value of walking for ever, from which all others are counted.
    pub fn floor(&self) -> f64 {
        self.step / (1.0 - self.gamma)
    }

    /// The discount.
    pub fn gamma(&self) -> f64 {
        self.gamma
    }

    /// The value of a percept above the floor; 0 if no way to a goal is known.
    pub fn value(&self, percept: usize) -> f64 {
        self.values.get(percept).copied().unwrap_or(0.0)
    }

    /// The pairs that were followed by a percept.
    pub fn before(&self, percept: usize) -> &[(usize, Action)] {
        self.before.get(percept).map_or(&[], Vec::as_slice)
    }

    /// Takes note of what followed a pair, and passes on what that changes.
    pub fn learn(&mut self, memory: &Transitions, pair: (usize, Action), next: Option<usize>) {
        let met = memory.percepts().len();
        self.values.resize(met, 0.0);
        self.before.resize(met, Vec::new());
        if let Some(next) = next
            && !self.before[next].contains(&pair)
        {
            self.before[next].push(pair);
        }
        self.update(memory, pair.0);
        for _ in 0..MOST_UPDATES {
            let Some((_, Reverse(percept))) = self.queue.pop() else {
                return;
            };
            self.update(memory, percept);
        }
    }

    /// The value of a pair above the floor; `None` if it was never tried.
    fn value_of(&self, memory: &Transitions, percept: usize, action: Action) -> Option<f64> {
        let outcomes = memory.outcomes(percept, action);
        let after = |next: Option<usize>| next.map_or(-self.floor(), |next| self.values[next]);
        let value = outcomes.mean(|o| o.reward - self.step + self.gamma * after(o.next));
        (outcomes.tries() > 0).then_some(value)
    }

    fn update(&mut self, memory: &Transitions, percept: usize) {
        let values = Action::all(self.actions);
        let values = values.filter_map(|action| self.value_of(memory, percept, action));
        let value = values.fold(0.0, f64::max);
        let old = std::mem::replace(&mut self.values[percept], value);
        self.touched.push(percept);
        let greater = value.max(old);
        if (value - old).abs() > NEGLIGIBLE * greater {
            for &(before, _) in &self.before[percept] {
                // Values are not negative, so that their bits are in their order.
                self.queue.push((greater.to_bits(), Reverse(before)));
            }
        }
    }

    /// The lessons that may have changed since this was asked last, by the number of the percept.
    pub fn news(&mut self, memory: &Transitions) -> Vec<(usize, Lesson)> {
        let mut touched = std::mem::take(&mut self.touched);
        touched.sort_unstable();
        touched.dedup();
        let lessons = touched
            .into_iter()
            .filter(|&percept| self.values[percept] > 0.0);
        lessons
            .map(|percept| (percept, self.lesson(memory, percept)))
            .collect()
    }

    /// What is best in a percept.
    fn lesson(&self, memory: &Transitions, percept: usize) -> Lesson {
        let value = self.values[percept];
        let mut best = [false; MAX_ACTIONS];
        for action in Action::all(self.actions) {
            let own = self.value_of(memory, percept, action);
            best[action.index()] = own.is_some_and(|own| own >= value * (1.0 - TIE));
        }
        Lesson {
            percept: memory.percepts()[percept],
            best,
            value: value + self.floor(),
        }
    }
}
