//! The match set \[M\] and the action set \[A\].

use serde::{Deserialize, Serialize};

use super::classifier::Classifier;
use super::condition::Condition;
use super::handles::ClassifierId;
use super::population::Population;
use super::prediction::PredictionSums;
use super::representation::Representation;
use crate::action::Action;

/// \[M\]: the rules that matched a percept when the set was formed. Reused from step to step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound = "C: Representation")]
pub struct MatchSet<C: Representation = Condition> {
    percept: Option<C::Percept>,
    /// The rules that advocate each action, in population order. Has as many lists as were needed
    /// so far.
    members: Vec<Vec<ClassifierId>>,
    /// The number of micro-classifiers.
    micro: u32,
    /// Accumulated while \[M\] is formed, because looking the rules up again would cost as much as
    /// finding them.
    sums: PredictionSums,
}

impl<C: Representation> Default for MatchSet<C> {
    fn default() -> Self {
        Self {
            percept: None,
            members: Vec::new(),
            micro: 0,
            sums: PredictionSums::default(),
        }
    }
}

impl<C: Representation> MatchSet<C> {
    /// Clears \[M\] for another percept.
    pub(super) fn clear(&mut self, percept: &C::Percept) {
        self.percept = Some(percept.clone());
        self.members.iter_mut().for_each(Vec::clear);
        self.micro = 0;
        self.sums.clear();
    }

    /// Adds a matching rule.
    #[inline]
    pub(super) fn add(&mut self, id: ClassifierId, rule: &Classifier<C>) {
        let at = rule.action.index();
        match self.members.get_mut(at) {
            Some(members) => members.push(id),
            None => self.add_first(at, id),
        }
        self.micro += rule.numerosity;
        self.sums.add(rule);
    }

    /// Adds the first rule that advocates an action. Not inlined, because it is rare.
    #[cold]
    fn add_first(&mut self, at: usize, id: ClassifierId) {
        self.members.resize(at + 1, Vec::new());
        self.members[at].push(id);
    }

    /// Returns true if a rule advocates the action.
    pub(super) fn covers(&self, action: Action) -> bool {
        let advocates = self.members.get(action.index());
        advocates.is_some_and(|ids| !ids.is_empty())
    }

    /// Returns the sums that the action values are computed from.
    pub(super) fn sums(&self) -> &PredictionSums {
        &self.sums
    }

    /// Returns the ids of the rules, by action.
    pub(super) fn members(&self) -> &[Vec<ClassifierId>] {
        &self.members
    }

    /// Returns the percept of \[M\]; `None` if \[M\] was never formed.
    pub(super) fn percept(&self) -> Option<&C::Percept> {
        self.percept.as_ref()
    }

    /// Replaces the ids of the rules that have not been deleted by those of a restored population, and forgets the others.
    pub(super) fn renumber(&mut self, population: &Population<C>) {
        self.members
            .iter_mut()
            .for_each(|ids| renumber(ids, population));
    }

    /// Returns the number of micro-classifiers in \[M\] when it was formed.
    pub fn micro(&self) -> u32 {
        self.micro
    }

    /// Returns true if no rule matches.
    pub fn is_empty(&self) -> bool {
        self.micro == 0
    }

    /// Returns \[A\]: the rules of \[M\] that advocate `action`. Returns `None` if \[M\] was never
    /// formed.
    pub fn action_set(&self, action: Action) -> Option<ActionSet<C>> {
        Some(ActionSet {
            percept: self.percept.clone()?,
            action,
            members: self
                .members
                .get(action.index())
                .cloned()
                .unwrap_or_default(),
        })
    }
}

/// \[A\]: the rules that advocated the chosen action in a percept. Stores ids, because the set may
/// outlive deleted rules.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound = "C: Representation")]
pub struct ActionSet<C: Representation = Condition> {
    /// The percept that the rules match.
    pub percept: C::Percept,
    /// The action that the rules advocate.
    pub action: Action,
    pub(super) members: Vec<ClassifierId>,
}

impl<C: Representation> ActionSet<C> {
    /// Returns the ids of the rules, including rules deleted since.
    pub fn members(&self) -> &[ClassifierId] {
        &self.members
    }

    /// Does what [`MatchSet::renumber`] does.
    pub(super) fn renumber(&mut self, population: &Population<C>) {
        renumber(&mut self.members, population);
    }
}

fn renumber<C: Representation>(ids: &mut Vec<ClassifierId>, population: &Population<C>) {
    let positions = ids.iter().filter_map(|&id| population.position(id));
    *ids = positions.map(ClassifierId::first_at).collect();
}
