//! What is known to be worth how much: values of what was tried, and of ways back that are
//! foretold, kept up to date step by step.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::ReturnRule;
use super::return_rules::{Counts, ReturnRules};
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

/// The value of each percept under the best policy over what is known, by prioritised sweeping
/// (Moore and Atkeson 1993): a change is passed backward, the greatest values first, and touches
/// only what depends on it. Known is what was tried and, until it is tried, the way back of a move
/// that has always led to the same percept: exploration spares it, so lessons must trust it.
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
    returns: ReturnRules,
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
            returns: ReturnRules::new(actions),
            queue: BinaryHeap::new(),
            touched: Vec::new(),
        }
    }

    /// What learning has changed so far: the values, what came before each percept, and the rules
    /// about ways back.
    pub fn kept(&self) -> (&[f64], &Before, Counts) {
        (&self.values, &self.before, self.returns.kept())
    }

    /// Goes on from what was kept; `false` if it is not about the percepts of the memory, or there is
    /// no room in the counts.
    pub fn resume(
        &mut self,
        (values, before, returns): (Vec<f64>, Before, Counts),
        memory: &Transitions,
    ) -> bool {
        (self.values, self.before) = (values, before);
        let met = memory.percepts().len();
        let mut pairs = self.before.iter().flatten();
        self.returns.resume(returns)
            && self.values.len() <= met
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

    /// The rules about ways back.
    pub fn returns(&self) -> &ReturnRules {
        &self.returns
    }

    /// Takes rules about ways back from another world.
    pub fn bring(&mut self, returns: &[ReturnRule]) {
        self.returns.bring(returns);
    }

    /// The percept to which an untried action is foretold to lead back.
    pub fn way_back(&self, memory: &Transitions, percept: usize, action: Action) -> Option<usize> {
        let before = self.before.get(percept)?;
        self.returns.way_back(memory, before, (percept, action))
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
        // There, a way back may have opened or closed.
        let nexts = memory.outcomes(pair.0, pair.1).nexts();
        nexts.for_each(|next| self.push(next, self.values[pair.0]));
        self.pass_on(memory);
    }

    /// Takes note of whether `next`, taken right after a move by `first`, led back, and passes on
    /// what that changes; true if it changes what is foretold.
    pub fn learn_return(
        &mut self,
        memory: &Transitions,
        [first, next]: [Action; 2],
        back: bool,
    ) -> bool {
        let news = self.returns.learn(first, next, back);
        if news {
            (0..self.values.len()).for_each(|percept| self.push(percept, self.values[percept]));
            self.pass_on(memory);
        }
        news
    }

    fn pass_on(&mut self, memory: &Transitions) {
        for _ in 0..MOST_UPDATES {
            let Some((_, Reverse(percept))) = self.queue.pop() else {
                return;
            };
            self.update(memory, percept);
        }
    }

    /// The value of a pair above the floor; `None` if nothing is known of it.
    fn value_of(&self, memory: &Transitions, percept: usize, action: Action) -> Option<f64> {
        let outcomes = memory.outcomes(percept, action);
        if outcomes.tries() == 0 {
            let back = self.way_back(memory, percept, action)?;
            return Some(self.gamma * self.values[back]);
        }
        let after = |next: Option<usize>| next.map_or(-self.floor(), |next| self.values[next]);
        Some(outcomes.mean(|o| o.reward - self.step + self.gamma * after(o.next)))
    }

    fn update(&mut self, memory: &Transitions, percept: usize) {
        let values = Action::all(self.actions);
        let values = values.filter_map(|action| self.value_of(memory, percept, action));
        let value = values.fold(0.0, f64::max);
        let old = std::mem::replace(&mut self.values[percept], value);
        self.touched.push(percept);
        let greater = value.max(old);
        if (value - old).abs() <= NEGLIGIBLE * greater {
            return;
        }
        for at in 0..self.before[percept].len() {
            self.push(self.before[percept][at].0, greater);
        }
        // From where its own moves lead, a way back may lead here.
        for action in Action::all(self.actions) {
            let there = memory.outcomes(percept, action).only_next();
            there
                .into_iter()
                .for_each(|there| self.push(there, greater));
        }
    }

    /// The value of a percept is to be updated, because one of `value` has changed.
    fn push(&mut self, percept: usize, value: f64) {
        // Values are not negative, so that their bits are in their order.
        self.queue.push((value.to_bits(), Reverse(percept)));
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
