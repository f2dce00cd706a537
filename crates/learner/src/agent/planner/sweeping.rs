//! What is known to be worth how much: values of what was tried, and of ways back that are
//! predicted, kept up to date step by step.
//!
//! Where moves slip, a value counts steps alone: a collision by a slip costs no more than a step. For
//! who is far from the goal, all that is to come there is worth less than the collisions that slips
//! cost on the way, and it would be best never to set out.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::agent::model::ReturnRule;
use crate::agent::model::return_rules::{Counts, ReturnRules};
use crate::agent::model::transitions::Transitions;
use crate::agent::params::Params;
use xcs::LabelledExample;
use xcs::{Action, ByAction};

/// Changes of a value by less than this share of it are not passed on.
const NEGLIGIBLE: f64 = 1e-9;
/// The same where nothing is new, and only the odds of a pair have changed: they are not known that
/// well. Measured with slipping moves (Maze4, slip 0.1 and 0.25, 60 trials): policies as good as
/// with a billionth, at an eighth of the time; with a ten-thousandth training collides more.
const NEGLIGIBLE_ODDS: f64 = 1e-5;
/// The same where moves slip, and all values depend on each other. With a billionth a step takes half as
/// long again in 40 x 40 rooms.
const NEGLIGIBLE_SLIPPING: f64 = 1e-7;
/// Actions whose values differ by less than this share are equally good.
const TIE: f64 = 1e-7;
/// A greater discount would leave values without a floor.
const GREATEST_DISCOUNT: f64 = 0.999_999;
/// Values that may be updated at the beginning, and so many more with each step; what is left waits
/// for later steps. Where moves are exact, this is more than there ever is to do. With noise every
/// value depends a little on all others, and far more could be done at each step. Too few updates
/// cost quality: with 32 a step, policies in Maze4 took a quarter more steps at slip 0.1 and 0.25.
const FIRST_UPDATES: usize = 100_000;
const UPDATES_PER_STEP: usize = 1_024;
/// Updates at once where nothing is new, and only the odds of a pair have changed.
const UPDATES_FOR_ODDS: usize = 1_024;
/// Places in the queue for each percept, on average, before it is tidied up.
const MOST_PLACES: usize = 4;

/// By percept: the pairs that were followed by it.
pub(in crate::agent) type Before = Vec<Vec<(usize, Action)>>;

/// How many values may be updated, and the percepts of those that wait for it, each with the bits of
/// the value for which it is.
type Waiting = (usize, Vec<(u64, Reverse<usize>)>);

/// The value of each percept under the best policy over what is known, by prioritised sweeping
/// (Moore and Atkeson 1993): a change is passed backward, the greatest values first, and touches
/// only what depends on it. PlannedValues is what was tried and, until it is tried, the way back of a move
/// that has always led to the same percept: exploration spares it, so examples must trust it.
///
/// Values are counted from that of walking for ever, `step / (1 - gamma)`. So counted, a value is
/// `gamma` to the power of the steps to the goal, times a constant: it stays exact thousands of
/// steps away, and 0 means that no way is known.
#[derive(Debug, Clone)]
pub(in crate::agent) struct PlannedValues {
    actions: usize,
    gamma: f64,
    step: f64,
    /// By the number of the percept.
    values: Vec<f64>,
    before: Before,
    returns: ReturnRules,
    /// Percepts whose value is to be updated, the greatest first.
    queue: BinaryHeap<(u64, Reverse<usize>)>,
    /// How many values may be updated.
    updates: usize,
    /// By percept: has anything changed on which its value depends, since that was updated?
    stale: Vec<bool>,
    /// Percepts of which the example may have changed.
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
            returns: ReturnRules::new(actions),
            queue: BinaryHeap::new(),
            updates: FIRST_UPDATES,
            stale: Vec::new(),
            touched: Vec::new(),
        }
    }

    /// Moves slip more or less than was believed: works out everything anew.
    pub fn reconsider(&mut self, memory: &Transitions) {
        self.returns.allow(memory.slips());
        (0..self.values.len()).for_each(|percept| self.push(percept, self.values[percept]));
        self.pass_on(memory, usize::MAX, NEGLIGIBLE_SLIPPING);
    }

    /// What learning has changed so far: the values, how many may be updated and which wait for it,
    /// what came before each percept, and the rules about ways back.
    pub fn kept(&self) -> (&[f64], Waiting, &Before, Counts) {
        let queue = self.queue.clone().into_sorted_vec();
        let waiting = (self.updates, queue);
        (&self.values, waiting, &self.before, self.returns.kept())
    }

    /// Goes on from what was kept; `false` if it is not about the percepts of the memory, or there is
    /// no room in the counts.
    pub fn resume(
        &mut self,
        (values, waiting, before, returns): (Vec<f64>, Waiting, Before, Counts),
        memory: &Transitions,
    ) -> bool {
        let known = values.len();
        (self.values, self.before) = (values, before);
        self.stale = vec![false; known];
        let met = memory.percepts().len();
        let mut pairs = self.before.iter().flatten();
        self.returns.allow(memory.slips());
        self.returns.resume(returns)
            && known <= met
            && self.before.len() == known
            && self
                .values
                .iter()
                .all(|value| value.is_finite() && *value >= 0.0)
            && pairs.all(|&(percept, action)| percept < known && action.index() < self.actions)
            && self.go_on_waiting(waiting)
    }

    /// Goes on with what was waiting; `false` if that is not known, or not in its order.
    fn go_on_waiting(&mut self, (updates, queue): Waiting) -> bool {
        self.updates = updates;
        for &(_, Reverse(percept)) in &queue {
            match self.stale.get_mut(percept) {
                Some(stale) if !*stale => *stale = true,
                _ => return false,
            }
        }
        self.queue = queue.into();
        true
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

    /// The percept to which an untried action is predicted to lead back.
    pub fn way_back(&self, memory: &Transitions, percept: usize, action: Action) -> Option<usize> {
        let before = self.before.get(percept)?;
        self.returns.way_back(memory, before, (percept, action))
    }

    /// Takes note of what followed a pair, and passes on what that changes.
    pub fn learn(&mut self, memory: &Transitions, pair: (usize, Action), next: Option<usize>) {
        let met = memory.percepts().len();
        self.values.resize(met, 0.0);
        self.before.resize(met, Vec::new());
        self.stale.resize(met, false);
        if let Some(next) = next
            && !self.before[next].contains(&pair)
        {
            self.before[next].push(pair);
        }
        let is_new = memory.outcomes(pair.0, pair.1).tries() == 1;
        let (most, negligible) = match is_new {
            _ if memory.slips().any() => (UPDATES_FOR_ODDS, NEGLIGIBLE_SLIPPING),
            true => (usize::MAX, NEGLIGIBLE),
            false => (UPDATES_FOR_ODDS, NEGLIGIBLE_ODDS),
        };
        self.update(memory, pair.0, negligible);
        // There, a way back may have opened or closed.
        let nexts = memory.outcomes(pair.0, pair.1).nexts();
        nexts.for_each(|next| self.push(next, self.values[pair.0]));
        self.updates = self.updates.saturating_add(UPDATES_PER_STEP);
        self.pass_on(memory, most, negligible);
    }

    /// Takes note of whether `next`, taken right after a move by `first`, led back, and passes on
    /// what that changes; true if it changes what is predicted.
    pub fn learn_return(
        &mut self,
        memory: &Transitions,
        [first, next]: [Action; 2],
        back: bool,
    ) -> bool {
        let news = self.returns.learn(first, next, back);
        if news {
            (0..self.values.len()).for_each(|percept| self.push(percept, self.values[percept]));
            self.pass_on(memory, usize::MAX, NEGLIGIBLE);
        }
        news
    }

    /// Updates what waits for it, at most so many values. What has not changed is skipped: places
    /// in the queue are often many for one percept.
    fn pass_on(&mut self, memory: &Transitions, most: usize, negligible: f64) {
        let mut left = most.min(self.updates);
        self.updates -= left;
        while left > 0
            && let Some((_, Reverse(percept))) = self.queue.pop()
        {
            if std::mem::take(&mut self.stale[percept]) {
                self.update(memory, percept, negligible);
                left -= 1;
            }
        }
        self.updates += left;
        if self.queue.len() > MOST_PLACES * self.values.len() {
            self.tidy();
        }
    }

    /// Leaves of what waits one place for each percept, the first.
    pub fn tidy(&mut self) {
        let mut queue = std::mem::take(&mut self.queue).into_vec();
        queue.sort_unstable_by_key(|&(place, Reverse(percept))| (percept, Reverse(place)));
        queue.dedup_by_key(|&mut (_, percept)| percept);
        queue.retain(|&(_, Reverse(percept))| self.stale[percept]);
        self.queue = queue.into();
    }

    /// The value of a pair above the floor, if it does not slip; `None` if nothing is known of it.
    fn value_of(&self, memory: &Transitions, percept: usize, action: Action) -> Option<f64> {
        if !memory.is_known(percept, action) {
            let back = self.way_back(memory, percept, action)?;
            return Some(self.gamma * self.values[back]);
        }
        let after = |next: Option<usize>| next.map_or(-self.floor(), |next| self.values[next]);
        let least = match memory.slips().any() {
            true => 0.0,
            false => f64::NEG_INFINITY,
        };
        Some(memory.mean(percept, action, |o| {
            (o.reward - self.step).max(least) + self.gamma * after(o.next)
        }))
    }

    /// The greatest value of the pairs of a percept; 0 if none of them leads to a goal.
    fn greatest(&self, memory: &Transitions, percept: usize) -> f64 {
        let values = Action::all(self.actions);
        let values = values.filter_map(|action| self.value_of(memory, percept, action));
        values.fold(0.0, f64::max)
    }

    /// The value of a percept where moves slip.
    fn slipping_value(&self, memory: &Transitions, percept: usize) -> f64 {
        if !memory.is_explained(percept) {
            return self.greatest(memory, percept);
        }
        let mut values = ByAction::default();
        for action in Action::all(self.actions) {
            if memory.next(percept, action) != Some(percept) {
                values[action.index()] = self.value_of(memory, percept, action);
            }
        }
        memory.slips().value(&values[..self.actions], self.gamma)
    }

    fn update(&mut self, memory: &Transitions, percept: usize, negligible: f64) {
        let value = match memory.slips().any() {
            true => self.slipping_value(memory, percept),
            false => self.greatest(memory, percept),
        };
        let old = std::mem::replace(&mut self.values[percept], value);
        self.touched.push(percept);
        if value == old {
            return;
        }
        let greater = value.max(old);
        let is_great = (value - old).abs() > negligible * greater;
        // From where its own moves lead, a way back may lead here.
        let own = Action::all(self.actions).filter_map(|action| memory.next(percept, action));
        let before = std::mem::take(&mut self.before[percept]);
        let depends = |&&(other, action): &&(usize, Action)| {
            let depends = memory.next(other, action) == Some(percept);
            depends || !memory.slips().any() || !memory.is_explained(other)
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

    /// The value of a percept is to be updated, because one of `value` has changed.
    fn push(&mut self, percept: usize, value: f64) {
        // Values are not negative, so that their bits are in their order.
        self.queue.push((value.to_bits(), Reverse(percept)));
        self.stale[percept] = true;
    }

    /// The examples that may have changed since this was asked last, by the number of the percept.
    pub fn news(&mut self, memory: &Transitions) -> Vec<(usize, LabelledExample)> {
        let mut touched = std::mem::take(&mut self.touched);
        touched.sort_unstable();
        touched.dedup();
        let labelled_examples = touched
            .into_iter()
            .filter(|&percept| self.values[percept] > 0.0);
        labelled_examples
            .map(|percept| (percept, self.labelled_example(memory, percept)))
            .collect()
    }

    /// Returns the values of the actions in a percept, those of the best exactly alike; nothing where no path to a
    /// goal is known.
    pub fn action_values(
        &self,
        memory: &Transitions,
        percept: usize,
    ) -> impl Iterator<Item = (Action, f64)> {
        let is_known = self.value(percept) > 0.0;
        let greatest = if is_known {
            self.greatest(memory, percept)
        } else {
            0.0
        };
        let actions = Action::all(self.actions).filter(move |_| is_known);
        actions.filter_map(move |action| {
            let value = self.value_of(memory, percept, action)?;
            let is_best = value >= greatest * (1.0 - TIE);
            Some((
                action,
                self.floor() + if is_best { greatest } else { value },
            ))
        })
    }

    /// Is an action one of the best in a percept, as far as is known?
    pub fn is_best(&self, memory: &Transitions, percept: usize, action: Action) -> bool {
        self.value(percept) > 0.0 && self.labelled_example(memory, percept).best[action.index()]
    }

    /// What is best in a percept.
    fn labelled_example(&self, memory: &Transitions, percept: usize) -> LabelledExample {
        let value = self.values[percept];
        let greatest = match memory.slips().any() {
            true => self.greatest(memory, percept),
            false => value,
        };
        let mut best = ByAction::default();
        for action in Action::all(self.actions) {
            let own = self.value_of(memory, percept, action);
            best[action.index()] = own.is_some_and(|own| own >= greatest * (1.0 - TIE));
        }
        LabelledExample {
            percept: memory.percepts()[percept],
            best,
            value: value + self.floor(),
        }
    }
}

#[cfg(test)]
mod tests;
