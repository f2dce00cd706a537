//! A rule policy: the decisions of a plan, distilled by sequential covering (CN2, Clark and Niblett 1989).

use crate::agent::StepCredit;
use crate::agent::credit::step_credit;
use xcs::{
    Action, Induction, LabelledExample, LabelledExamples, Layout, MatchSet, Percept,
    PredictionArray, Xcs,
};

/// A population of best-action rules, and the labelled examples that it is distilled from.
#[derive(Debug, Clone)]
pub struct RulePolicy {
    xcs: Xcs,
    match_set: MatchSet,
    examples: LabelledExamples,
    induction: Induction,
}

impl RulePolicy {
    /// Creates a policy without rules and examples, for percepts with this layout.
    pub fn new(xcs: Xcs, layout: Layout) -> Self {
        Self {
            xcs,
            match_set: MatchSet::default(),
            examples: LabelledExamples::default().with_layout(layout),
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
}
