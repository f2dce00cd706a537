//! An agent that only uses what is known.

use serde::Serialize;

use super::knowledge::Knowledge;
use super::recall::Tracker;
use super::{Agent, EndCredit, StepCredit};
use crate::arena::Outcome;
use xcs::{Action, Percept, PredictionArray};

/// A method that no longer learns: it acts on what is known and changes nothing.
#[derive(Debug, Clone, Serialize)]
pub struct Frozen {
    knowledge: Knowledge,
    actions: usize,
    step_threshold: u32,
    /// What it remembers of this episode.
    tracker: Tracker,
}

impl Frozen {
    /// Acts on `knowledge` with `actions` actions, for at most `step_threshold` steps an episode.
    pub fn new(knowledge: Knowledge, actions: usize, step_threshold: u32) -> Self {
        Self {
            knowledge,
            actions,
            step_threshold,
            tracker: Tracker::default(),
        }
    }
}

impl Agent for Frozen {
    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        let Knowledge::Remembering { map, .. } = &self.knowledge else {
            return self.worth(percept);
        };
        self.tracker.perceive(map, percept);
        self.knowledge.remembered_worth(&self.tracker, self.actions)
    }

    fn credit(&mut self, action: Action, _: Outcome) -> StepCredit {
        self.tracker.act(action);
        StepCredit::default()
    }

    fn finish(&mut self, _: bool) -> EndCredit {
        self.tracker = Tracker::default();
        EndCredit {
            long_term_reward: 0.0,
            learning_rate: 0.0,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        self.step_threshold
    }

    fn worth(&self, percept: &Percept) -> PredictionArray {
        self.knowledge.worth(percept, self.actions)
    }

    fn knowledge(&self) -> Knowledge {
        self.knowledge.clone()
    }

    fn rule_count(&self) -> usize {
        self.knowledge.len()
    }
}
