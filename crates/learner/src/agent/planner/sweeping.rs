//! Values of percepts over tried pairs and predicted returns, updated incrementally.
//!
//! If moves slip, rewards count no lower than a step: a collision after a slip costs no more than a step. Otherwise,
//! far from the goal, the collisions of slips on the path would outweigh the discounted reward, and never moving
//! would be best.

mod decisions;

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::agent::credit::params::Params;
use crate::agent::model::InverseActionRule;
use crate::agent::model::inverse_action_rules::InverseActionRules;
use crate::agent::model::transitions::Transitions;
use xcs::{Action, ByAction};

/// Relative changes of a value below this are not propagated.
const NEGLIGIBLE: f64 = 1e-9;
/// The same if no pair is new, and only the probabilities of a pair changed: they are not known
/// that precisely. Measured with slipping moves (Maze4, slip 0.1 and 0.25, 60 trials): policies as
/// good as with 1e-9, at an eighth of the time; with 1e-4 training collides more.
const NEGLIGIBLE_ODDS: f64 = 1e-5;
/// The same if moves slip and all values depend on each other. With 1e-9 a step takes 1.5 times as long in 40 x 40
/// rooms.
const NEGLIGIBLE_SLIPPING: f64 = 1e-7;
/// The maximum discount; above it values would have no floor.
const GREATEST_DISCOUNT: f64 = 0.999_999;
/// The number of value updates allowed at the beginning; each step allows `UPDATES_PER_STEP` more.
/// The rest waits for later steps. With exact moves, this exceeds the total work. With noise every
/// value depends slightly on all others, and each step could use far more. Too few updates cost
/// quality: with 32 a step, policies in Maze4 took a quarter more steps at slip 0.1 and 0.25.
const FIRST_UPDATES: usize = 100_000;
const UPDATES_PER_STEP: usize = 1_024;
/// The maximum number of updates per call if only the probabilities of a pair changed.
const UPDATES_FOR_ODDS: usize = 1_024;
/// The average number of queue entries per percept above which the queue is compacted.
const MOST_ENTRIES: usize = 4;

/// The value of each percept under the best policy over known pairs, by prioritised sweeping (Moore and Atkeson
/// 1993). The model changes in every step, so that values are updated one by one. A change propagates backward, greatest values first, and only to values that depend on it. Known pairs are
/// the tried pairs and, until they are tried, the predicted returns of moves. Exploration does not try predicted
/// returns, so the examples must rely on them.
///
/// Values are relative to the value of walking for ever, `step / (1 - gamma)`. A value is then
/// `gamma` to the power of the steps to the goal, times a constant. It stays exact thousands of
/// steps away, and 0 means that no path is known.
#[derive(Debug, Clone)]
pub(in crate::agent) struct PlannedValues {
    actions: usize,
    gamma: f64,
    step: f64,
    /// By the number of the percept.
    values: Vec<f64>,
    /// By percept: the pairs that led to it.
    before: Vec<Vec<(usize, Action)>>,
    returns: InverseActionRules,
    /// Percepts that wait for an update, greatest value first.
    queue: BinaryHeap<(u64, Reverse<usize>)>,
    /// The number of updates allowed.
    updates: usize,
    /// By percept: true if a value that it depends on changed since its last update.
    stale: Vec<bool>,
    /// Percepts whose example may have changed.
    touched: Vec<usize>,
}

impl PlannedValues {
    pub fn new(actions: usize, params: &Params) -> Self {
        Self {
            actions,
            gamma: params.gamma.min(GREATEST_DISCOUNT),
            step: params.step,
            values: Vec::new(),
            before: Vec::new(),
            returns: InverseActionRules::new(actions),
            queue: BinaryHeap::new(),
            updates: FIRST_UPDATES,
            stale: Vec::new(),
            touched: Vec::new(),
        }
    }

    /// Makes room for the values of new percepts.
    fn meet(&mut self, model: &Transitions) {
        let met = model.percepts().len();
        self.values.resize(met, 0.0);
        self.before.resize(met, Vec::new());
        self.stale.resize(met, false);
    }

    /// Recomputes all values after the slip probability changed.
    pub fn reconsider(&mut self, model: &Transitions) {
        self.returns.allow(model.slips());
        (0..self.values.len()).for_each(|percept| self.push(percept, self.values[percept]));
        self.propagate(model, usize::MAX, NEGLIGIBLE_SLIPPING);
    }

    /// Returns the value of walking for ever, which all other values are relative to.
    pub fn floor(&self) -> f64 {
        self.step / (1.0 - self.gamma)
    }

    /// Returns the discount.
    pub fn gamma(&self) -> f64 {
        self.gamma
    }

    /// Returns the value of a percept above the floor; 0 if no path to a goal is known.
    pub fn value(&self, percept: usize) -> f64 {
        self.values.get(percept).copied().unwrap_or(0.0)
    }

    /// Returns the inverse-action rules.
    pub fn returns(&self) -> &InverseActionRules {
        &self.returns
    }

    /// Adopts inverse-action rules from another world.
    pub fn warm_start(&mut self, returns: &[InverseActionRule]) {
        self.returns.warm_start(returns);
    }

    /// Returns the percept to which an untried action is predicted to return.
    pub fn predicted_return(
        &self,
        model: &Transitions,
        percept: usize,
        action: Action,
    ) -> Option<usize> {
        let before = self.before.get(percept)?;
        self.returns
            .predicted_return(model, before, (percept, action))
    }

    /// Records the successor of a pair, and propagates the change.
    pub fn learn(&mut self, model: &Transitions, pair: (usize, Action), next: Option<usize>) {
        self.meet(model);
        if let Some(next) = next
            && !self.before[next].contains(&pair)
        {
            self.before[next].push(pair);
        }
        let is_new = model.outcomes(pair.0, pair.1).tries() == 1;
        let (most, negligible) = match is_new {
            _ if model.slips().any() => (UPDATES_FOR_ODDS, NEGLIGIBLE_SLIPPING),
            true => (usize::MAX, NEGLIGIBLE),
            false => (UPDATES_FOR_ODDS, NEGLIGIBLE_ODDS),
        };
        self.update(model, pair.0, negligible);
        // The prediction of a return may have changed there.
        let nexts = model.outcomes(pair.0, pair.1).nexts();
        nexts.for_each(|next| self.push(next, self.values[pair.0]));
        self.updates = self.updates.saturating_add(UPDATES_PER_STEP);
        self.propagate(model, most, negligible);
    }

    /// Records whether `next`, right after a move by `first`, led back, and propagates the change.
    /// Returns true if a prediction changed.
    pub fn learn_return(
        &mut self,
        model: &Transitions,
        [first, next]: [Action; 2],
        back: bool,
    ) -> bool {
        let news = self.returns.learn(first, next, back);
        if news {
            (0..self.values.len()).for_each(|percept| self.push(percept, self.values[percept]));
            self.propagate(model, usize::MAX, NEGLIGIBLE);
        }
        news
    }

    /// Updates waiting values, at most `most` of them. Percepts without changes are skipped: a
    /// percept often has several entries in the queue.
    fn propagate(&mut self, model: &Transitions, most: usize, negligible: f64) {
        let mut left = most.min(self.updates);
        self.updates -= left;
        while left > 0
            && let Some((_, Reverse(percept))) = self.queue.pop()
        {
            if std::mem::take(&mut self.stale[percept]) {
                self.update(model, percept, negligible);
                left -= 1;
            }
        }
        self.updates += left;
        if self.queue.len() > MOST_ENTRIES * self.values.len() {
            self.tidy();
        }
    }

    /// Reduces the queue to one entry for each waiting percept, the first.
    pub fn tidy(&mut self) {
        let mut queue = std::mem::take(&mut self.queue).into_vec();
        queue.sort_unstable_by_key(|&(entry, Reverse(percept))| (percept, Reverse(entry)));
        queue.dedup_by_key(|&mut (_, percept)| percept);
        queue.retain(|&(_, Reverse(percept))| self.stale[percept]);
        self.queue = queue.into();
    }

    /// Returns the value of a pair above the floor, if the move does not slip; `None` if the pair
    /// is not known.
    fn value_of(&self, model: &Transitions, percept: usize, action: Action) -> Option<f64> {
        if !model.is_known(percept, action) {
            let back = self.predicted_return(model, percept, action)?;
            return Some(self.gamma * self.values[back]);
        }
        let after = |next: Option<usize>| next.map_or(0.0 - self.floor(), |next| self.values[next]);
        let least = match model.slips().any() {
            true => 0.0,
            false => f64::NEG_INFINITY,
        };
        Some(model.mean(percept, action, |o| {
            (o.reward - self.step).max(least) + self.gamma * after(o.next)
        }))
    }

    /// Returns the greatest value of the pairs of a percept; 0 if none of them leads to a goal.
    fn greatest(&self, model: &Transitions, percept: usize) -> f64 {
        let values = Action::all(self.actions);
        let values = values.filter_map(|action| self.value_of(model, percept, action));
        values.fold(0.0, f64::max)
    }

    /// Returns the value of a percept if moves slip.
    fn slipping_value(&self, model: &Transitions, percept: usize) -> f64 {
        if !model.is_explained(percept) {
            return self.greatest(model, percept);
        }
        let mut values = ByAction::default();
        for action in Action::all(self.actions) {
            if model.next(percept, action) != Some(percept) {
                values[action.index()] = self.value_of(model, percept, action);
            }
        }
        model.slips().value(&values[..self.actions], self.gamma)
    }

    fn update(&mut self, model: &Transitions, percept: usize, negligible: f64) {
        let value = match model.slips().any() {
            true => self.slipping_value(model, percept),
            false => self.greatest(model, percept),
        };
        let old = std::mem::replace(&mut self.values[percept], value);
        self.touched.push(percept);
        if value == old {
            return;
        }
        let greater = value.max(old);
        let is_great = (value - old).abs() > negligible * greater;
        // A return may lead here from where its own moves lead.
        let own = Action::all(self.actions).filter_map(|action| model.next(percept, action));
        let before = std::mem::take(&mut self.before[percept]);
        let depends = |&&(other, action): &&(usize, Action)| {
            let depends = model.next(other, action) == Some(percept);
            depends || !model.slips().any() || !model.is_explained(other)
        };
        let others = before.iter().filter(depends).map(|&(other, _)| other);
        for other in others.chain(own) {
            match is_great {
                true => self.push(other, greater),
                false => self.stale[other] = true,
            }
        }
        self.before[percept] = before;
    }

    /// Queues a percept for an update, because a value of `value` changed.
    fn push(&mut self, percept: usize, value: f64) {
        // Values are not negative, so their bits sort in the same order.
        self.queue.push((value.to_bits(), Reverse(percept)));
        self.stale[percept] = true;
    }
}

#[cfg(test)]
mod tests;
