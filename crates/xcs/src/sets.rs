//! The match set \[M\] and the action set \[A\].

use super::classifier::Classifier;
use super::handles::ClassifierId;
use super::prediction::{PredictionArray, PredictionSums};
use crate::signal::{Action, ByAction, Percept};

/// \[M\]: the rules that match a percept, as they were when it was formed. Reused from step to
/// step.
#[derive(Debug, Clone, Default)]
pub struct MatchSet {
    percept: Option<Percept>,
    /// The rules that advocate each action, in the order of the population.
    members: ByAction<Vec<ClassifierId>>,
    /// Micro-classifiers.
    micro: u32,
    /// Added up while the rules are at hand: looking them up again would cost as much as finding
    /// them.
    sums: PredictionSums,
}

impl MatchSet {
    /// Begins \[M\] of another percept.
    pub(super) fn clear(&mut self, percept: &Percept) {
        self.percept = Some(*percept);
        self.members.iter_mut().for_each(Vec::clear);
        self.micro = 0;
        self.sums = PredictionSums::default();
    }

    /// Adds a rule that matches.
    pub(super) fn add(&mut self, id: ClassifierId, rule: &Classifier) {
        self.members[rule.action.index()].push(id);
        self.micro += rule.numerosity;
        self.sums.add(rule);
    }

    /// Does a rule advocate the action?
    pub(super) fn covers(&self, action: Action) -> bool {
        !self.members[action.index()].is_empty()
    }

    /// The prediction array of `actions` actions (Eq. 6).
    pub(super) fn prediction(&self, actions: usize, over_match_set: bool) -> PredictionArray {
        self.sums.array(actions, over_match_set)
    }

    /// The ids of its rules, by action.
    pub(super) fn members(&self) -> &[Vec<ClassifierId>] {
        &self.members
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
    pub fn action_set(&self, action: Action) -> Option<ActionSet> {
        Some(ActionSet {
            percept: self.percept?,
            action,
            members: self.members[action.index()].clone(),
        })
    }
}

/// \[A\]: the rules that advocated the chosen action in a percept. It holds ids, because it may
/// outlive rules that get deleted.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionSet {
    /// The percept that its rules match.
    pub percept: Percept,
    /// The action that its rules advocate.
    pub action: Action,
    pub(super) members: Vec<ClassifierId>,
}

impl ActionSet {
    /// The ids of its rules, some of which may have been deleted since.
    pub fn members(&self) -> &[ClassifierId] {
        &self.members
    }
}
