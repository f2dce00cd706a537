//! A rule policy: the decisions of a plan, distilled by sequential covering (CN2, Clark and Niblett 1989).

use serde::{Deserialize, Serialize};

use crate::agent::StepCredit;
use crate::agent::credit::step_credit;
use xcs::{
    Action, Induction, LabelledExample, LabelledExamples, Layout, Learned, MatchSet, Percept,
    PredictionArray, Xcs,
};

/// A population of best-action rules, and the labelled examples that it is distilled from.
#[derive(Debug, Clone)]
pub struct RulePolicy {
    xcs: Xcs,
    match_set: MatchSet,
    layout: Layout,
    examples: LabelledExamples,
    induction: Induction,
}

/// What learning changes.
#[derive(Debug, Serialize, Deserialize)]
pub struct RuleState {
    rules: Learned,
    examples: LabelledExamples,
}

impl RulePolicy {
    /// Creates a policy without rules and examples, for percepts with this layout.
    pub fn new(xcs: Xcs, layout: Layout) -> Self {
        Self {
            xcs,
            match_set: MatchSet::default(),
            examples: LabelledExamples::default().with_layout(layout.clone()),
            layout,
            induction: Induction::default(),
        }
    }

    /// The classifier system that holds the rules.
    pub fn xcs(&self) -> &Xcs {
        &self.xcs
    }

    /// Adds examples, by the number of their percept, and corrects the rules if any example changed.
    pub fn distil(&mut self, examples: Vec<(usize, LabelledExample)>) {
        for (number, example) in examples {
            self.examples.give(number, example);
        }
        if self.examples.have_changed() {
            self.xcs.induce(&mut self.induction, &mut self.examples);
        }
    }

    /// Returns the value of each action in a percept, and forms the match set for [`credit`](Self::credit).
    pub fn predict(&mut self, percept: &Percept) -> PredictionArray {
        self.xcs
            .match_without_covering(percept, &mut self.match_set);
        self.xcs.predict(&self.match_set)
    }

    /// Describes the rules that advocated an action in the percept of the last [`predict`](Self::predict).
    pub fn credit(&self, action: Action, short_term_reward: f64) -> StepCredit {
        let action_set = self.match_set.action_set(action);
        let action_set =
            action_set.expect("`predict` forms the match set before an action is chosen");
        step_credit(&self.xcs, &self.match_set, &action_set, short_term_reward)
    }

    /// Returns the learned state.
    pub fn state(&self) -> RuleState {
        RuleState {
            rules: self.xcs.learned(),
            examples: self.examples.clone(),
        }
    }

    /// Resumes from a learned state; `false` if the rules or the examples do not fit `percepts`.
    pub fn resume(&mut self, state: RuleState, percepts: &[Percept]) -> bool {
        let RuleState { rules, examples } = state;
        let fits = |(number, example): (usize, &LabelledExample)| {
            percepts.get(number) == Some(&example.percept) && example.value.is_finite()
        };
        let valid = examples.iter().all(fits) && self.xcs.resume(rules);
        self.examples = examples.with_layout(self.layout.clone());
        valid
    }
}
