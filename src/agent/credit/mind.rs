//! XCS in the middle of a step: what all its reward methods share.

use serde::{Deserialize, Serialize};

use crate::agent::StepCredit;
use crate::agent::knowledge::Knowledge;
use xcs::{Action, Percept};
use xcs::{ActionSet, MatchSet, PredictionArray, Xcs};

/// A learner together with the match set that it is deciding on.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Mind {
    pub xcs: Xcs,
    #[serde(skip)]
    match_set: MatchSet,
}

impl Mind {
    pub fn new(xcs: Xcs) -> Self {
        Self {
            xcs,
            match_set: MatchSet::default(),
        }
    }

    /// Can this mind, read from a file, stand for one that began as `fresh`?
    pub fn descends_from(&self, fresh: &Self) -> bool {
        self.xcs.descends_from(&fresh.xcs)
    }

    /// Starts from rules that were learned elsewhere; `false` if there are none.
    pub fn bring(&mut self, knowledge: &Knowledge) -> bool {
        knowledge.rules().is_some_and(|rules| {
            self.xcs.start_from(rules);
            true
        })
    }

    /// What was learned.
    pub fn knowledge(&self) -> Knowledge {
        let rules = self.xcs.population().clone();
        match self.xcs.params().worth_over_match_set {
            true => Knowledge::RulesOverMatchSet(rules),
            false => Knowledge::Rules(rules),
        }
    }

    /// Forms \[M\] and predicts.
    pub fn consider(&mut self, percept: &Percept) -> PredictionArray {
        self.xcs.form_match_set(percept, &mut self.match_set);
        self.xcs.predict(&self.match_set)
    }

    /// Forms \[M\] without covering, and predicts.
    pub fn look(&mut self, percept: &Percept) -> PredictionArray {
        self.xcs
            .match_without_covering(percept, &mut self.match_set);
        self.xcs.predict(&self.match_set)
    }

    /// \[A\] of the chosen action.
    pub fn action_set(&self, action: Action) -> ActionSet {
        let set = self.match_set.action_set(action);
        set.expect("consider comes before credit and forms [M]")
    }

    /// What there is to say of a step of this action, before anything is updated.
    pub fn step_credit_of(&self, action: Action, short_term_reward: f64) -> StepCredit {
        self.step_credit(&self.action_set(action), short_term_reward)
    }

    /// What there is to say of a step, before anything is updated.
    pub fn step_credit(&self, set: &ActionSet, short_term_reward: f64) -> StepCredit {
        let (action_set, error) = self.xcs.size_and_error(set);
        StepCredit {
            fired: self.xcs.strongest(set).map(|rule| rule.condition),
            short_term_reward,
            error,
            match_set: self.match_set.micro(),
            action_set,
        }
    }
}
