//! Standard XCS and XCSAM: the reward travels back one step at a time, as in Q-learning.

use serde::{Deserialize, Serialize};

use super::mind::Mind;
use crate::agent::explorer::Explorer;
use crate::agent::knowledge::Knowledge;
use crate::agent::memory::{self, MemoryError};
use crate::agent::params::{Params, StepLimitUpdate, XcsPayment};
use crate::agent::{Agent, Choice, EndCredit, StepCredit};
use crate::arena::Outcome;
use xcs::{Action, Percept};
use xcs::{ActionSet, PredictionArray, Xcs};

/// The methods `xcs` and, around a learner with an adaptive mapping, `xcsam`: the previous \[A\]
/// is updated with its reward plus gamma times the greatest worth of the present percept; the last
/// \[A\] of an episode with its reward alone.
///
/// [`XcsPayment`] says which rewards these are, [`StepLimitUpdate`] what the step limit means.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Standard {
    mind: Mind,
    params: Params,
    /// The greatest worth of the present percept.
    #[serde(skip)]
    greatest: f64,
    #[serde(skip)]
    previous: Option<Waiting>,
    /// Steps of this episode so far.
    #[serde(skip)]
    steps: usize,
}

/// An action set whose payoff is not known yet.
#[derive(Debug, Clone)]
struct Waiting {
    set: ActionSet,
    /// What it is paid at once.
    reward: f64,
    /// The greatest worth of its percept, when its action was chosen.
    greatest: f64,
}

impl Standard {
    /// Around a learner; the parameters must have been checked.
    pub fn new(xcs: Xcs, params: Params) -> Self {
        Self {
            mind: Mind::new(xcs),
            params,
            greatest: 0.0,
            previous: None,
            steps: 0,
        }
    }

    /// Can this method, read from a file, stand for one that began as `fresh`?
    pub(super) fn descends_from(&self, fresh: &Self) -> bool {
        self.params == fresh.params && self.mind.descends_from(&fresh.mind)
    }

    /// Pays an action set its reward and what followed it.
    fn learn(&mut self, waiting: &Waiting, followed: f64) {
        let Waiting { set, greatest, .. } = waiting;
        let payoff = waiting.reward + followed;
        let xcs = &mut self.mind.xcs;
        xcs.adapt_mapping(set, payoff, *greatest);
        xcs.update(set, payoff, xcs.params().beta);
        xcs.evolve(set);
    }
}

impl Agent for Standard {
    fn begin(&mut self, evolves: bool) {
        self.mind.xcs.let_evolve(evolves);
    }

    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        let worth = self.mind.consider(percept);
        self.greatest = worth.greatest().unwrap_or(0.0);
        worth
    }

    /// Explores, as Butz and Wilson do, only actions that rules of \[M\] advocate.
    fn choose(&mut self, worth: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let (action, explores) = explorer.choose_advocated(worth);
        Choice::of_rules(action, explores)
    }

    fn credit(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let set = self.mind.action_set(action);
        let reward = self.params.short_term(outcome);
        let credit = self.mind.step_credit(&set, reward);
        let greatest = self.greatest;
        let paid = match self.params.xcs_payment {
            XcsPayment::All => reward,
            XcsPayment::Final => 0.0,
        };
        self.steps += 1;
        let waiting = Waiting {
            set,
            reward: paid,
            greatest,
        };
        if let Some(previous) = self.previous.replace(waiting) {
            self.learn(&previous, self.params.gamma * greatest);
        }
        credit
    }

    fn finish(&mut self, reached_goal: bool) -> EndCredit {
        let steps = std::mem::take(&mut self.steps);
        let long_term_reward = match self.params.xcs_payment {
            XcsPayment::All if reached_goal => self.params.goal,
            _ => self.params.long_term(reached_goal, steps),
        };
        let counts = reached_goal || self.params.xcs_step_limit == StepLimitUpdate::Failure;
        if let Some(last) = self.previous.take().filter(|_| counts) {
            self.learn(&last, long_term_reward);
        }
        EndCredit {
            long_term_reward,
            learning_rate: self.mind.xcs.params().beta,
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
