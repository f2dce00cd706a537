//! XCSCR: the combined reward method of the paper.
//!
//! Four mechanisms in a fixed order, each in its own file and with its own switch:
//! 1. [`short_term_filter`](super::short_term_filter): a collision lowers the worth of the rules that caused it, at once;
//! 2. [`learning_rate`](super::learning_rate): successes are learned fast, failures slowly;
//! 3. [`imprinting`](super::imprinting): after a failure, one of the best policies so far is rehearsed;
//! 4. [`step_threshold`](super::step_threshold): the time allowed shrinks toward the best policy.

use serde::{Deserialize, Serialize};

use super::imprinting::{self, Imprinting};
use super::learning_rate::LearningRate;
use super::short_term_filter::ShortTermFilter;
use super::step_threshold::StepThreshold;

use super::mind::Mind;
use super::stack::{RewardStack, Shares};
use crate::agent::knowledge::Knowledge;
use crate::agent::memory::{self, MemoryError};
use crate::agent::params::Params;
use crate::agent::{Agent, EndCredit, StepCredit};
use crate::arena::Outcome;
use xcs::random::Stream;
use xcs::{Action, Percept};
use xcs::{PredictionArray, Xcs};

/// The method `xcscr` (paper, section III and figure 1.c); with all four mechanisms switched off,
/// the methods `adapted-even` and `adapted-discounted`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Combined {
    mind: Mind,
    params: Params,
    #[serde(skip)]
    stack: RewardStack,
    /// Length of the shortest success so far; `usize::MAX` before the first.
    shortest: usize,
    filter: ShortTermFilter,
    learning_rate: LearningRate,
    imprinting: Imprinting,
    step_threshold: StepThreshold,
}

impl Combined {
    /// Around a learner; `stream` decides about imprinting. The parameters must have been checked.
    pub fn new(xcs: Xcs, params: Params, stream: Stream) -> Self {
        Self {
            filter: ShortTermFilter::new(&params),
            learning_rate: LearningRate::new(&params, xcs.params().beta),
            imprinting: Imprinting::new(&params, stream),
            step_threshold: StepThreshold::new(&params),
            mind: Mind::new(xcs),
            params,
            stack: RewardStack::default(),
            shortest: usize::MAX,
        }
    }

    /// Can this method, read from a file, stand for one that began as `fresh`?
    pub(super) fn descends_from(&self, fresh: &Self) -> bool {
        self.params == fresh.params
            && self.mind.descends_from(&fresh.mind)
            && self.filter == fresh.filter
            && self.learning_rate == fresh.learning_rate
            && self.imprinting.descends_from(&fresh.imprinting)
            && self.step_threshold.descends_from(&fresh.step_threshold)
    }

    /// The shares of a reward r_l among the steps of an episode or policy.
    fn shares(&self, reward: f64, steps: usize) -> Shares {
        Shares::new(
            reward,
            steps,
            self.shortest,
            self.params.sharing,
            &self.params,
        )
    }
}

impl Agent for Combined {
    fn begin(&mut self, evolves: bool) {
        self.mind.xcs.let_evolve(evolves);
    }

    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        self.mind.consider(percept)
    }

    fn credit(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let set = self.mind.action_set(action);
        let reward = self.params.short_term(outcome);
        let credit = self.mind.step_credit(&set, reward);
        let beta = self.learning_rate.after_collision();
        self.filter.answer(&mut self.mind.xcs, &set, reward, beta);
        self.stack
            .push(&mut self.mind.xcs, set, self.params.stack_evolution);
        credit
    }

    fn finish(&mut self, reached_goal: bool) -> EndCredit {
        let steps = self.stack.len();
        if reached_goal {
            self.shortest = self.shortest.min(steps);
        }
        let policy = self.stack.policy();
        let long_term_reward = self.params.long_term(reached_goal, steps);
        let learning_rate = self.learning_rate.after(reached_goal);
        let shares = self.shares(long_term_reward, steps);
        let evolution = self.params.stack_evolution;
        self.stack
            .unwind(&mut self.mind.xcs, &shares, learning_rate, evolution);
        let rehearsed = self
            .imprinting
            .after(reached_goal, policy)
            .map(<[_]>::to_vec);
        if let Some(policy) = &rehearsed {
            let reward = self.params.long_term(true, policy.len());
            let shares = self.shares(reward, policy.len());
            let beta = self.learning_rate.after(true);
            imprinting::clone_behaviour(&mut self.mind.xcs, policy, &shares, beta);
        }
        if reached_goal {
            self.step_threshold.learn(steps);
        }
        EndCredit {
            long_term_reward,
            learning_rate,
            imprinted: rehearsed.is_some(),
        }
    }

    fn step_threshold(&self) -> u32 {
        self.step_threshold.steps()
    }

    fn worth(&self, percept: &Percept) -> PredictionArray {
        self.mind.xcs.worth(percept)
    }

    fn knowledge(&self) -> Knowledge {
        self.mind.knowledge()
    }

    fn bring(&mut self, knowledge: &Knowledge) -> bool {
        self.mind.bring(knowledge)
    }

    fn rule_count(&self) -> usize {
        self.mind.xcs.population().len()
    }

    fn memory(&self) -> Vec<u8> {
        memory::of(self)
    }

    fn restored(&self, saved: &[u8]) -> Result<Box<dyn Agent>, MemoryError> {
        let method = memory::recall(saved, |it: &Self| it.descends_from(self))?;
        Ok(Box::new(method))
    }
}
