//! An agent that stores, for each percept and action, the fewest steps to a goal observed so far.

use std::collections::BTreeMap;

use xcscr::agent::{Agent, EndCredit, Knowledge, StepCredit, Transition};
use xcscr::trial::Plan;
use xcscr::xcs::{Action, Percept, PredictionArray};

/// The fewest steps to a goal after each action, by percept.
pub struct FewestSteps {
    actions: usize,
    step_threshold: u32,
    fewest: BTreeMap<Percept, Vec<Option<f64>>>,
    episode: Vec<(Percept, Action)>,
}

impl FewestSteps {
    /// Creates an untrained agent for the trial of this plan.
    pub fn new(plan: &Plan) -> Self {
        Self {
            actions: plan.maze.action_count(),
            step_threshold: plan.config.settings.reward.step_threshold,
            fewest: BTreeMap::new(),
            episode: Vec::new(),
        }
    }
}

impl Agent for FewestSteps {
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.values(percept)
    }

    fn update(&mut self, step: &Transition<'_>) -> StepCredit {
        self.episode.push((*step.percept, step.action));
        StepCredit::default()
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        for (back, (percept, action)) in self.episode.drain(..).rev().enumerate() {
            if reached_goal {
                let row = self
                    .fewest
                    .entry(percept)
                    .or_insert(vec![None; self.actions]);
                let steps = -(back as f64);
                let known = &mut row[action.index()];
                *known = Some(known.map_or(steps, |best| best.max(steps)));
            }
        }
        EndCredit {
            long_term_reward: 0.0,
            learning_rate: 1.0,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        self.step_threshold
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.knowledge().values(percept, self.actions)
    }

    fn knowledge(&self) -> Knowledge {
        Knowledge::Table(self.fewest.clone())
    }

    fn rule_count(&self) -> usize {
        self.fewest.len()
    }
}
