//! An agent that follows learned knowledge without learning.

use serde::Serialize;

use crate::agent::credit::credit_of_rules;
use crate::agent::knowledge::Knowledge;
use crate::agent::{Agent, Choice, DecisionSource, EndCredit, Explorer, StepCredit};
use xcs::{Action, Condition, Percept, PredictionArray};
use xcscr_robot::arena::Outcome;

/// A frozen method: it acts on its knowledge and changes nothing.
#[derive(Debug, Clone, Serialize)]
pub struct Frozen {
    knowledge: Knowledge,
    actions: usize,
    step_threshold: u32,
    /// The last percept.
    #[serde(skip)]
    percept: Option<Percept>,
}

impl Frozen {
    /// Creates an agent with `actions` actions and at most `step_threshold` steps an episode.
    pub fn new(knowledge: Knowledge, actions: usize, step_threshold: u32) -> Self {
        Self {
            knowledge,
            actions,
            step_threshold,
            percept: None,
        }
    }

    /// Returns the condition of the rule with the most weight among those that match the last observation and
    /// advocate `action`; `None` if there is none.
    pub fn decisive_rule(&self, action: Action) -> Option<Condition> {
        self.matching(action).fired
    }

    /// Describes the rules that match the current percept; empty for a table.
    fn matching(&self, action: Action) -> StepCredit {
        match self.knowledge.rules().zip(self.percept) {
            Some((rules, percept)) => credit_of_rules(rules, &percept, action),
            None => StepCredit::default(),
        }
    }
}

impl Agent for Frozen {
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.percept = Some(*percept);
        self.values(percept)
    }

    fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let (action, explores) = explorer.choose(values);
        let by_chance = explores || values.greatest().is_none();
        let source = match self.knowledge.rules() {
            Some(_) => DecisionSource::Rules,
            None => DecisionSource::Table,
        };
        Choice::by(source, action, by_chance)
    }

    fn update(&mut self, action: Action, _: Outcome, _: Option<&Percept>) -> StepCredit {
        self.matching(action)
    }

    fn end_episode(&mut self, _: bool) -> EndCredit {
        EndCredit::new(0.0, 0.0)
    }

    fn step_threshold(&self) -> u32 {
        self.step_threshold
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.knowledge.values(percept, self.actions)
    }

    fn knowledge(&self) -> Knowledge {
        self.knowledge.clone()
    }

    fn rule_count(&self) -> usize {
        self.knowledge.len()
    }
}
