//! XCS adapted to robots (Williams et al.): one reward at the end, shared out along \[R\].

use serde::{Deserialize, Serialize};

use super::mind::Mind;
use super::params::{Params, Sharing};
use super::stack::{RewardStack, Shares};
use crate::agent::knowledge::Knowledge;
use crate::agent::memory::{self, MemoryError};
use crate::agent::{Agent, EndCredit, StepCredit};
use crate::arena::Outcome;
use xcs::{Action, Percept};
use xcs::{PredictionArray, Xcs};

/// The methods `adapted-even` and `adapted-discounted`: every \[A\] of an episode waits in \[R\]
/// for its share of the long-term reward (Eq. 7 with 8 or 9).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Adapted {
    mind: Mind,
    params: Params,
    sharing: Sharing,
    #[serde(skip)]
    stack: RewardStack,
    /// Length of the shortest success so far; `usize::MAX` before the first.
    shortest: usize,
}

impl Adapted {
    /// Around a learner; the parameters must have been checked.
    pub fn new(xcs: Xcs, params: Params, sharing: Sharing) -> Self {
        Self {
            mind: Mind::new(xcs),
            params,
            sharing,
            stack: RewardStack::default(),
            shortest: usize::MAX,
        }
    }

    /// Can this method, read from a file, stand for one that began as `fresh`?
    pub(super) fn descends_from(&self, fresh: &Self) -> bool {
        self.params == fresh.params
            && self.sharing == fresh.sharing
            && self.mind.descends_from(&fresh.mind)
    }
}

impl Agent for Adapted {
    fn begin(&mut self, evolves: bool) {
        self.mind.xcs.let_evolve(evolves);
    }

    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        self.mind.consider(percept)
    }

    fn credit(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let set = self.mind.action_set(action);
        let credit = self.mind.step_credit(&set, self.params.short_term(outcome));
        self.stack
            .push(&mut self.mind.xcs, set, self.params.stack_evolution);
        credit
    }

    fn finish(&mut self, reached_goal: bool) -> EndCredit {
        let steps = self.stack.len();
        if reached_goal {
            self.shortest = self.shortest.min(steps);
        }
        let reward = self.params.long_term(reached_goal, steps);
        let shares = Shares::new(reward, steps, self.shortest, self.sharing, &self.params);
        let beta = self.mind.xcs.params().beta;
        let evolution = self.params.stack_evolution;
        self.stack
            .unwind(&mut self.mind.xcs, &shares, beta, evolution);
        EndCredit {
            long_term_reward: reward,
            learning_rate: beta,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        self.params.step_threshold
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
