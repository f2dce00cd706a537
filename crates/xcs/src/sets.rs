//! The match set \[M\] and the action set \[A\].

use serde::{Deserialize, Serialize};

use super::classifier::Classifier;
use super::condition::Condition;
use super::handles::ClassifierId;
use super::population::Population;
use super::prediction::{PredictionArray, PredictionSums};
use super::representation::Representation;
use crate::signal::Action;

/// \[M\]: the rules that match a percept, as they were when it was formed. Reused from step to
/// step.
#[derive(Debug, Clone)]
pub struct MatchSet<C: Representation = Condition> {
    percept: Option<C::Percept>,
    /// The rules that advocate each action, in the order of the population; as many lists as were
    /// needed so far.
    members: Vec<Vec<ClassifierId>>,
    /// Micro-classifiers.
    micro: u32,
    /// Added up while the rules are at hand: looking them up again would cost as much as finding
    /// them.
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
    /// Begins \[M\] of another percept.
    pub(super) fn clear(&mut self, percept: &C::Percept) {
        self.percept = Some(percept.clone());
        self.members.iter_mut().for_each(Vec::clear);
        self.micro = 0;
        self.sums = PredictionSums::default();
    }

    /// Adds a rule that matches.
    pub(super) fn add(&mut self, id: ClassifierId, rule: &Classifier<C>) {
        let at = rule.action.index();
        if at >= self.members.len() {
            self.members.resize(at + 1, Vec::new());
        }
        self.members[at].push(id);
        self.micro += rule.numerosity;
        self.sums.add(rule);
    }

    /// Does a rule advocate the action?
    pub(super) fn covers(&self, action: Action) -> bool {
        let advocates = self.members.get(action.index());
        advocates.is_some_and(|ids| !ids.is_empty())
    }

    /// The prediction array of `actions` actions (Eq. 6).
    pub(super) fn prediction(&self, actions: usize, over_match_set: bool) -> PredictionArray {
        self.sums.array(actions, over_match_set)
    }

    /// Returns the sums from which the value of each action comes.
    pub(super) fn sums(&self) -> &PredictionSums {
        &self.sums
    }

    /// The ids of its rules, by action.
    pub(super) fn members(&self) -> &[Vec<ClassifierId>] {
        &self.members
    }

    /// Returns the percept of \[M\]; `None` before \[M\] was ever formed.
    pub(super) fn percept(&self) -> Option<&C::Percept> {
        self.percept.as_ref()
    }

    /// Returns the set with the positions of its rules that were not deleted.
    pub(super) fn saved(&self, population: &Population<C>) -> Option<SavedMatchSet<C>> {
        let lists = self.members.iter();
        Some(SavedMatchSet {
            percept: self.percept.clone()?,
            members: lists.map(|ids| positions(ids, population)).collect(),
            micro: self.micro,
            sums: self.sums.clone(),
        })
    }

    /// Micro-classifiers in \[M\] when it was formed.
    pub fn micro(&self) -> u32 {
        self.micro
    }

    /// Macro-classifiers in \[M\] when it was formed.
    pub fn len(&self) -> usize {
        self.members.iter().map(Vec::len).sum()
    }

    /// Does no rule match?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// \[A\]: the rules of \[M\] that advocate `action`; `None` before \[M\] was ever formed.
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

/// \[A\]: the rules that advocated the chosen action in a percept. It holds ids, because it may
/// outlive rules that get deleted.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionSet<C: Representation = Condition> {
    /// The percept that its rules match.
    pub percept: C::Percept,
    /// The action that its rules advocate.
    pub action: Action,
    pub(super) members: Vec<ClassifierId>,
}

impl<C: Representation> ActionSet<C> {
    /// The ids of its rules, some of which may have been deleted since.
    pub fn members(&self) -> &[ClassifierId] {
        &self.members
    }

    /// Returns the set with the positions of its rules that were not deleted.
    pub(super) fn saved(&self, population: &Population<C>) -> SavedActionSet<C> {
        SavedActionSet {
            percept: self.percept.clone(),
            action: self.action,
            members: positions(&self.members, population),
        }
    }
}

/// \[M\] as files store it, with positions in the population in place of ids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound = "C: Representation")]
pub(super) struct SavedMatchSet<C: Representation> {
    percept: C::Percept,
    members: Vec<Vec<u32>>,
    micro: u32,
    sums: PredictionSums,
}

impl<C: Representation> SavedMatchSet<C> {
    /// Returns the set; `None` if it is not one of this population and number of actions.
    pub fn restored(self, population: &Population<C>, actions: usize) -> Option<MatchSet<C>> {
        let lists = self.members.iter();
        let members: Option<Vec<_>> = lists.map(|list| ids(list, population)).collect();
        let members = members.filter(|members| members.len() <= actions)?;
        Some(MatchSet {
            percept: Some(self.percept),
            members,
            micro: self.micro,
            sums: self.sums,
        })
    }
}

/// \[A\] as files store it, with positions in the population in place of ids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound = "C: Representation")]
pub(super) struct SavedActionSet<C: Representation> {
    percept: C::Percept,
    #[serde(deserialize_with = "Action::read::<C, _>")]
    action: Action,
    members: Vec<u32>,
}

impl<C: Representation> SavedActionSet<C> {
    /// Returns the set; `None` if it is not one of this population and number of actions.
    pub fn restored(self, population: &Population<C>, actions: usize) -> Option<ActionSet<C>> {
        let members = ids(&self.members, population)?;
        (self.action.index() < actions).then_some(ActionSet {
            percept: self.percept,
            action: self.action,
            members,
        })
    }
}

fn positions<C: Representation>(ids: &[ClassifierId], population: &Population<C>) -> Vec<u32> {
    let living = ids.iter().filter_map(|&id| population.position(id));
    living.map(|position| position as u32).collect()
}

fn ids<C: Representation>(
    positions: &[u32],
    population: &Population<C>,
) -> Option<Vec<ClassifierId>> {
    let exists = |&position: &u32| (position as usize) < population.len();
    let id = |position: u32| exists(&position).then(|| population.id_at(position as usize));
    positions.iter().map(|&position| id(position)).collect()
}
