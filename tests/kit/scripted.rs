//! A learner with scripted actions, which does not depend on the implementation of any learner.

use std::collections::BTreeMap;

use xcscr::agent::{Agent, EndCredit, Knowledge, StepCredit, Transition};
use xcscr::arena::Outcome;
use xcscr::xcs::PredictionArray;
use xcscr::xcs::{Action, Percept};

/// Follows one path per episode. A path is a string of compass letters.
pub struct Scripted {
    paths: Vec<&'static str>,
    episode: usize,
    step: usize,
}

impl Scripted {
    pub fn new(paths: &[&'static str]) -> Self {
        Self {
            paths: paths.to_vec(),
            episode: 0,
            step: 0,
        }
    }

    fn path(&self) -> &'static str {
        self.paths[self.episode % self.paths.len()]
    }
}

impl Agent for Scripted {
    fn observe(&mut self, _: &Percept) -> PredictionArray {
        let letter = self.path().as_bytes()[self.step];
        let wanted = b"NESW".iter().position(|&l| l == letter).unwrap();
        let mut values = PredictionArray::new(4);
        for action in Action::all(4) {
            let is_wanted = action.index() == wanted;
            values.set(action, if is_wanted { 100.0 } else { -7.25 });
        }
        values
    }

    fn update(&mut self, step: &Transition<'_>) -> StepCredit {
        self.step += 1;
        let hit = matches!(step.outcome, Outcome::Collided { .. });
        StepCredit {
            short_term_reward: if hit { -50.0 } else { -1.0 },
            ..StepCredit::default()
        }
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        self.episode += 1;
        self.step = 0;
        EndCredit {
            long_term_reward: if reached_goal { 1000.0 } else { 0.0 },
            learning_rate: 0.2,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        self.path().len() as u32
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        let mut values = PredictionArray::new(4);
        for action in Action::all(4) {
            let sign = if percept.bit(action.index()) {
                -1.0
            } else {
                1.0
            };
            values.set(action, sign * (action.index() + 1) as f64 * 50.0);
        }
        values
    }

    fn knowledge(&self) -> Knowledge {
        Knowledge::Table(BTreeMap::new())
    }

    fn rule_count(&self) -> usize {
        0
    }
}
