//! The population \[P\].

use std::collections::HashMap;

use foldhash::fast::FixedState;
use serde::{Deserialize, Serialize};

use super::classifier::Classifier;
use super::condition::Condition;
use super::deletion::DeletionVotes;
use super::handles::{ClassifierId, Handles};
use super::params::{GREATEST_POPULATION, Params};
use super::prediction::PredictionSums;
use super::representation::{Index, Representation};
use crate::action::Action;
use crate::random::Stream;

/// More steps than any run can reach. Counters up to this value leave room for arithmetic.
pub(super) const MOST_STEPS: u64 = 1 << 40;
/// The largest absolute value accepted from files, so that no sum or product of two is infinite.
const GREATEST_FIGURE: f64 = 1e100;

/// \[P\]: all rules. Each rule has an id that outlives it.
///
/// Rules are stored densely in a vector. The last rule takes the place of a removed one. The order
/// is part of the state, because roulette selection depends on it: a restored population continues
/// exactly as the saved one would have.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(
    into = "Vec<Classifier<C>>",
    try_from = "Vec<Classifier<C>>",
    bound = "C: Representation"
)]
pub struct Population<C: Representation = Condition> {
    rules: Vec<Classifier<C>>,
    handles: Handles,
    index: C::Index,
    votes: DeletionVotes,
    /// The rule with each condition and action. Never iterated over.
    twins: HashMap<(C, Action), ClassifierId, FixedState>,
    micro: u32,
}

impl<C: Representation> Default for Population<C> {
    fn default() -> Self {
        Self {
            rules: Vec::new(),
            handles: Handles::default(),
            index: C::Index::default(),
            votes: DeletionVotes::default(),
            twins: HashMap::default(),
            micro: 0,
        }
    }
}

impl<C: Representation> Population<C> {
    /// Returns the number of macro-classifiers.
    pub fn len(&self) -> usize {
        self.rules.len()
    }

    /// Returns true if there are no rules.
    pub fn is_empty(&self) -> bool {
        self.rules.is_empty()
    }

    /// Returns the sum of all numerosities.
    pub fn micro(&self) -> u32 {
        self.micro
    }

    /// Returns all rules, in population order.
    pub fn rules(&self) -> &[Classifier<C>] {
        &self.rules
    }

    /// Returns the rule with an id; `None` if it was deleted.
    pub fn get(&self, id: ClassifierId) -> Option<&Classifier<C>> {
        self.handles.position(id).map(|at| &self.rules[at])
    }

    /// Returns the position of a rule in [`Self::rules`]; `None` if it was deleted.
    pub(super) fn position(&self, id: ClassifierId) -> Option<usize> {
        self.handles.position(id)
    }

    /// Returns the rules among some ids that have not been deleted.
    pub(super) fn living<'a>(
        &'a self,
        ids: &'a [ClassifierId],
    ) -> impl Iterator<Item = (ClassifierId, &'a Classifier<C>)> + Clone {
        ids.iter().filter_map(|&id| Some((id, self.get(id)?)))
    }

    /// Returns a mutable rule. Condition, action and numerosity must not change. If the change
    /// affects its deletion vote, [`Self::modify`] must be called on the rule afterwards.
    pub(super) fn get_mut(&mut self, id: ClassifierId) -> Option<&mut Classifier<C>> {
        self.handles.position(id).map(|at| &mut self.rules[at])
    }

    /// Changes a rule; does nothing if it was deleted. Condition and action must not change.
    pub(super) fn modify(&mut self, id: ClassifierId, change: impl FnOnce(&mut Classifier<C>)) {
        let Some(at) = self.handles.position(id) else {
            return;
        };
        let rule = &mut self.rules[at];
        self.micro -= rule.numerosity;
        change(rule);
        self.micro += rule.numerosity;
        self.votes.touch(at);
    }

    /// Adds a rule. If a rule with the same condition and action exists, adds to its numerosity.
    pub(super) fn insert(&mut self, rule: Classifier<C>) -> ClassifierId {
        let key = (rule.condition.clone(), rule.action);
        if let Some(&twin) = self.twins.get(&key) {
            self.modify(twin, |twin| twin.numerosity += rule.numerosity);
            return twin;
        }
        self.micro += rule.numerosity;
        self.index.push(&rule.condition);
        self.votes.touch(self.rules.len());
        self.rules.push(rule);
        let id = self.handles.push();
        self.twins.insert(key, id);
        id
    }

    /// Returns true if there is a rule with this condition and action.
    pub(super) fn contains(&self, condition: &C, action: Action) -> bool {
        self.twins.contains_key(&(condition.clone(), action))
    }

    /// Removes a rule with all its numerosity and returns it.
    pub(super) fn remove(&mut self, id: ClassifierId) -> Option<Classifier<C>> {
        let at = self.handles.position(id)?;
        self.handles.swap_remove(at);
        self.index.swap_remove(at);
        let rule = self.rules.swap_remove(at);
        self.twins.remove(&(rule.condition.clone(), rule.action));
        self.micro -= rule.numerosity;
        self.votes.touch(at);
        self.votes.touch(self.rules.len());
        Some(rule)
    }

    /// Deletes micro-classifiers by roulette over their deletion votes until at most N remain.
    pub(super) fn delete_surplus(&mut self, params: &Params, stream: &mut Stream) {
        while self.micro > params.population_size {
            let ball = stream.unit();
            let at = self.votes.roulette(&self.rules, self.micro, params, ball);
            let id = self.handles.id_at(at);
            if self.rules[at].numerosity > 1 {
                self.modify(id, |rule| rule.numerosity -= 1);
            } else {
                self.remove(id);
            }
        }
    }

    /// Returns the sums of the rules that match a percept, from which action values are computed.
    pub fn sums(&self, percept: &C::Percept) -> PredictionSums {
        let mut sums = PredictionSums::default();
        self.for_each_match(percept, |_, rule| sums.add(rule));
        sums
    }

    /// Returns the same rules after a change, with the ids of rules that were inserted in this order. Condition and action
    /// must not change.
    pub(super) fn changed(&self, change: impl Fn(&mut Classifier<C>)) -> Self {
        let mut changed = Self::default();
        for mut rule in self.rules.iter().cloned() {
            change(&mut rule);
            changed.insert(rule);
        }
        changed
    }

    /// Calls `found` with each matching rule, in population order.
    pub fn for_each_match(
        &self,
        percept: &C::Percept,
        mut found: impl FnMut(ClassifierId, &Classifier<C>),
    ) {
        self.index
            .for_each_match(percept, |at| found(self.handles.id_at(at), &self.rules[at]));
    }
}

impl<C: Representation> PartialEq for Population<C> {
    fn eq(&self, other: &Self) -> bool {
        self.rules == other.rules
    }
}

impl<C: Representation> From<Population<C>> for Vec<Classifier<C>> {
    fn from(population: Population<C>) -> Self {
        population.rules
    }
}

/// An error in a list of rules that should form a population.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("rule {number} ({condition}) {fault}")]
pub struct PopulationError<C = Condition> {
    /// The rule's position in the list, from 1.
    pub number: usize,
    /// The rule's condition.
    pub condition: C,
    /// What is wrong with the rule.
    pub fault: &'static str,
}

impl<C: Representation> TryFrom<Vec<Classifier<C>>> for Population<C> {
    type Error = PopulationError<C>;

    fn try_from(rules: Vec<Classifier<C>>) -> Result<Self, PopulationError<C>> {
        let width = rules.first().map_or(0, |rule| rule.condition.width());
        let mut population = Self::default();
        for (at, rule) in rules.into_iter().enumerate() {
            let fault = |fault| PopulationError {
                number: at + 1,
                condition: rule.condition.clone(),
                fault,
            };
            fault_of(&rule, width).map_or(Ok(()), |text| Err(fault(text)))?;
            if population.micro.saturating_add(rule.numerosity) > GREATEST_POPULATION {
                return Err(fault("makes the sum of numerosities larger than 1,000,000"));
            }
            if population
                .twins
                .contains_key(&(rule.condition.clone(), rule.action))
            {
                return Err(fault("is listed twice with the same action"));
            }
            population.insert(rule);
        }
        Ok(population)
    }
}

/// Returns the reason why a rule from a file cannot join a population with conditions of `width`.
fn fault_of<C: Representation>(rule: &Classifier<C>, width: usize) -> Option<&'static str> {
    let figures = [rule.prediction, rule.error, rule.fitness];
    if rule.condition.width() != width {
        Some("has a condition of another width than the first rule")
    } else if rule.numerosity == 0 {
        Some("has numerosity 0, but must have at least 1")
    } else if !figures.iter().all(|figure| figure.abs() <= GREATEST_FIGURE) {
        Some("has a prediction, error or fitness that is not a number up to 1e100")
    } else if rule.fitness < 0.0 || rule.error < 0.0 {
        Some("has a fitness or an error below 0")
    } else if !(1.0..=f64::from(GREATEST_POPULATION)).contains(&rule.set_size) {
        Some("has a set size outside of 1 to 1,000,000")
    } else if rule.time_stamp > MOST_STEPS {
        Some("has a time stamp later than any run can reach")
    } else {
        None
    }
}

#[cfg(test)]
mod tests;
