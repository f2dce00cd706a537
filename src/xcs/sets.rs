//! The match set \[M\] and the action set \[A\].

use super::handles::ClassifierId;
use crate::signal::{Action, MAX_ACTIONS, Percept};

/// \[M\]: the rules that match a percept. Reused from step to step.
#[derive(Debug, Clone, Default)]
pub struct MatchSet {
    pub(super) percept: Option<Percept>,
    pub(super) members: Vec<Member>,
    /// Micro-classifiers.
    pub(super) micro: u32,
    /// Does a rule advocate the action?
    pub(super) covered: [bool; MAX_ACTIONS],
    pub(super) scratch: Vec<u64>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Member {
    pub id: ClassifierId,
    pub action: Action,
}

impl MatchSet {
    /// Micro-classifiers in \[M\] when it was formed.
    pub fn micro(&self) -> u32 {
        self.micro
    }

    /// Macro-classifiers in \[M\] when it was formed.
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Does no rule match?
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// \[A\]: the rules of \[M\] that advocate `action`; `None` before \[M\] was ever formed.
    pub fn action_set(&self, action: Action) -> Option<ActionSet> {
        let members = self.members.iter().filter(|member| member.action == action);
        Some(ActionSet {
            percept: self.percept?,
            action,
            members: members.map(|member| member.id).collect(),
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
