//! An agent that follows learned knowledge without learning.

use serde::Serialize;

use crate::agent::credit::credit_of_rules;
use crate::agent::estimator::map::Tracker;
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
    /// The state estimate of this episode.
    tracker: Tracker,
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
            tracker: Tracker::default(),
            percept: None,
        }
    }

    /// Returns the condition of the rule with the most weight among those that match the last observation and
    /// advocate `action`; `None` if there is none.
    pub fn decisive_rule(&self, action: Action) -> Option<Condition> {
        self.matching(action).fired
    }

    /// Describes the rules that match the current percept or context; empty for a table or a plan.
    fn matching(&self, action: Action) -> StepCredit {
        let context = match self.knowledge.map() {
            Some(map) => Some(self.tracker.context(map)),
            None => self.percept,
        };
        match self.knowledge.rules().zip(context) {
            Some((rules, context)) => credit_of_rules(rules, &context, action),
            None => StepCredit::default(),
        }
    }
}

impl Agent for Frozen {
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.percept = Some(*percept);
        let Some(map) = self.knowledge.map() else {
            return self.values(percept);
        };
        self.tracker.perceive(map, percept);
        self.knowledge.plan_for(&self.tracker);
        self.knowledge.tracked_values(&self.tracker, self.actions)
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

    fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let matching = self.matching(action);
        self.tracker.act(action, outcome.into());
        matching
    }

    fn end_episode(&mut self, _: bool) -> EndCredit {
        self.tracker = Tracker::default();
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
