//! The method `xcscr-memory`, and its rival without rules, around what they recall.

use super::explorer::Explorer;
use super::knowledge::Knowledge;
use super::memory::{self, MemoryError};
use super::recall::learner::{Decider, Learner};
use super::recall::{MemoryParams, Vision, Worth};
use super::{Agent, Choice, Chooser, EndCredit, Params, StepCredit};
use crate::arena::Outcome;
use xcs::PredictionArray;
use xcs::random::Stream;
use xcs::{Action, Percept};

/// The method `xcscr-memory`, or `r-max` with `tabular.memory`.
#[derive(Debug, Clone)]
pub struct Recall {
    learner: Learner,
    params: Params,
    /// What is perceived now.
    percept: Option<Percept>,
}

impl Recall {
    /// A learner for a body of so many actions, which sees like this; `stream` draws what is imagined
    /// and explored. The parameters must have been checked.
    pub fn new(
        body: (usize, Vision),
        xcs: xcs::Params,
        params: Params,
        own: MemoryParams,
        stream: Stream,
    ) -> Self {
        let Params {
            goal, step, gamma, ..
        } = params;
        let worth = Worth { goal, step, gamma };
        Self {
            learner: Learner::new(body, xcs, worth, own, stream),
            params,
            percept: None,
        }
    }

    /// The same without rules: its plan acts.
    pub fn by_plan(self) -> Self {
        let learner = self.learner.by_plan();
        Self { learner, ..self }
    }
}

impl Agent for Recall {
    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        self.percept = Some(*percept);
        self.learner.perceive(percept)
    }

    /// Explores in whole episodes, fewer and fewer of them, and where no rule matches; else the rules choose, or
    /// the plan of one who has no rules.
    fn choose(&mut self, worth: &PredictionArray, explorer: &mut Explorer) -> Choice {
        if self.learner.explores() || worth.greatest().is_none() {
            return Choice::new(self.learner.explore(), Chooser::Planner);
        }
        let chooser = match self.learner.decider() {
            Decider::Rules => Chooser::Rules,
            Decider::Plan => Chooser::Table,
        };
        Choice::new(explorer.exploit(worth), chooser)
    }

    fn credit(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let percept = self.percept.expect("consider comes before credit");
        let matching = self.learner.matching(action);
        let found = outcome.found();
        self.learner.act(&percept, action, outcome.into(), found);
        StepCredit {
            short_term_reward: self.params.short_term(outcome),
            match_set: matching.match_set,
            action_set: matching.action_set,
            fired: matching.fittest.map(|rule| rule.condition),
            ..StepCredit::default()
        }
    }

    fn finish(&mut self, reached_goal: bool) -> EndCredit {
        self.learner.finish(reached_goal);
        EndCredit {
            long_term_reward: if reached_goal { self.params.goal } else { 0.0 },
            learning_rate: 1.0,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        self.params.step_threshold
    }

    /// At the beginning of an episode.
    fn worth(&self, percept: &Percept) -> PredictionArray {
        self.learner.worth_at_first(percept)
    }

    fn knowledge(&self) -> Knowledge {
        match self.learner.decider() {
            Decider::Rules => Knowledge::Remembering {
                rules: self.learner.rules().clone(),
                map: self.learner.map().clone(),
            },
            Decider::Plan => Knowledge::Planned(self.learner.planned()),
        }
    }

    /// Only rules are brought along.
    fn bring(&mut self, knowledge: &Knowledge) -> bool {
        match (self.learner.decider(), knowledge) {
            (Decider::Rules, Knowledge::Remembering { rules, map }) => {
                self.learner.bring(rules, map);
                true
            }
            _ => false,
        }
    }

    fn remembers(&self) -> bool {
        true
    }

    fn rule_count(&self) -> usize {
        self.learner.size()
    }

    fn memory(&self) -> Vec<u8> {
        memory::of(&self.learner.kept())
    }

    fn restored(&self, saved: &[u8]) -> Result<Box<dyn Agent>, MemoryError> {
        let mut method = self.clone();
        let fits = method.learner.resume(memory::recall(saved)?);
        memory::resumed(method, fits)
    }
}
