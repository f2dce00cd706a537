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
use crate::random::Stream;
use crate::signal::Action;

/// More steps than any run can reach; counters up to here leave room for arithmetic.
pub(super) const MOST_STEPS: u64 = 1 << 40;
/// Figures of rules from files lie below this, so that no sum or product of two is infinite.
const GREATEST_FIGURE: f64 = 1e100;

/// \[P\]: all rules, each with an id that outlives it.
///
/// Rules lie densely in a vector; a removed rule's place is taken by the last one. The order is
/// part of the state, because roulettes walk along it: a restored population goes on exactly as
/// the saved one would have.
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
    /// The rule of a condition and action. Never iterated over.
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
    /// The number of macro-classifiers.
    pub fn len(&self) -> usize {
        self.rules.len()
    }

    /// Is there no rule at all?
    pub fn is_empty(&self) -> bool {
        self.rules.is_empty()
    }

    /// The sum of all numerosities.
    pub fn micro(&self) -> u32 {
        self.micro
    }

    /// All rules, in the order of the population.
    pub fn rules(&self) -> &[Classifier<C>] {
        &self.rules
    }

    /// The rule that an id names; `None` once it was deleted.
    pub fn get(&self, id: ClassifierId) -> Option<&Classifier<C>> {
        self.handles.position(id).map(|at| &self.rules[at])
    }

    /// Where a rule lies in [`Self::rules`]; `None` once it was deleted.
    pub(super) fn position(&self, id: ClassifierId) -> Option<usize> {
        self.handles.position(id)
    }

    /// The id of the rule at a position in [`Self::rules`].
    pub(super) fn id_at(&self, position: usize) -> ClassifierId {
        self.handles.id_at(position)
    }

    /// Those of some rules that have not been deleted.
    pub(super) fn living<'a>(
        &'a self,
        ids: &'a [ClassifierId],
    ) -> impl Iterator<Item = (ClassifierId, &'a Classifier<C>)> + Clone {
        ids.iter().filter_map(|&id| Some((id, self.get(id)?)))
    }

    /// A rule to be changed in anything but its condition, action and numerosity. If that moves
    /// its deletion vote, [`Self::modify`] must be called on it afterwards.
    pub(super) fn get_mut(&mut self, id: ClassifierId) -> Option<&mut Classifier<C>> {
        self.handles.position(id).map(|at| &mut self.rules[at])
    }

    /// Changes a rule; does nothing once it was deleted. Condition and action must stay.
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

    /// Adds a rule, or its numerosity to the rule that has the same condition and action.
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

    /// Deletes micro-classifiers by roulette over their deletion votes until at most N are left.
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

    /// What the value of each action under a percept comes from: the rules that match it.
    pub fn sums(&self, percept: &C::Percept) -> PredictionSums {
        let mut sums = PredictionSums::default();
        self.for_each_match(percept, |_, rule| sums.add(rule));
        sums
    }

    /// The same rules, whose records begin anew.
    pub fn without_records(&self) -> Self {
        let mut fresh = self.clone();
        for at in 0..fresh.len() {
            fresh.modify(fresh.id_at(at), |rule| {
                (rule.experience, rule.fitness) = (0, 1.0);
            });
        }
        fresh
    }

    /// Notes in the rules of \[A\] that they acted once more, and whether that was right. Experience counts
    /// the steps; fitness is the share that was right, with one right step to begin with, as the accuracy of
    /// UCS (Bernadó-Mansilla and Garrell, 2003). Tells whether there are any.
    pub fn record(&mut self, percept: &C::Percept, action: Action, right: bool) -> bool {
        let mut acted = Vec::new();
        self.for_each_match(percept, |id, rule| {
            if rule.action == action {
                acted.push(id);
            }
        });
        for &id in &acted {
            self.modify(id, |rule| {
                rule.experience = rule.experience.saturating_add(1);
                let steps = f64::from(rule.experience) + 1.0;
                rule.fitness += (f64::from(u8::from(right)) - rule.fitness) / steps;
            });
        }
        !acted.is_empty()
    }

    /// The same rules, all with the time stamp `time` and the effect of mapping `eam`.
    pub(super) fn stamped(&self, time: u64, eam: f32) -> Self {
        let mut stamped = Self::default();
        for rule in &self.rules {
            stamped.insert(Classifier {
                time_stamp: time,
                eam,
                ..rule.clone()
            });
        }
        stamped
    }

    /// The same rules, each with its eam; `None` unless there is one for each.
    pub(super) fn with_eams(mut self, eams: &[f32]) -> Option<Self> {
        for (at, (rule, &eam)) in self.rules.iter_mut().zip(eams).enumerate() {
            rule.eam = eam;
            self.votes.touch(at);
        }
        (self.rules.len() == eams.len()).then_some(self)
    }

    /// Calls `found` with each rule that matches, in the order of the population.
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

/// Rules that cannot form a population.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("rule {number} ({condition}) {fault}")]
pub struct PopulationError<C = Condition> {
    /// The rule's place in the list, from 1.
    pub number: usize,
    /// Its condition.
    pub condition: C,
    /// What is wrong with it.
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

/// What keeps a rule from a file out of a population with conditions of `width`.
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
