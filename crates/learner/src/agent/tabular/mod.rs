//! Tabular rivals on the same percepts, so that every claim about rules has its control.

mod params;
mod table;
mod traces;

pub use params::TabularParams;

use std::mem::discriminant;

use serde::{Deserialize, Serialize};

use table::{Rows, Table};
use traces::Traces;

use crate::agent::explorer::Explorer;
use crate::agent::knowledge::Knowledge;
use crate::agent::model::transitions::{Transition, Transitions};
use crate::agent::params::Params;
use crate::agent::saved::{self, RestoreError};
use crate::agent::{Agent, Choice, EndCredit, StepCredit};
use xcs::PredictionArray;
use xcs::random::Stream;
use xcs::{Action, Percept};
use xcscr_robot::arena::Outcome;

/// How a table of values is learned (Sutton and Barto 2018).
#[derive(Debug, Clone, Serialize, Deserialize)]
enum Algorithm {
    /// Toward the reward plus the best value after it.
    QLearning,
    /// Toward the reward plus the value of the action that was really chosen after it.
    SarsaLambda(Traces),
    /// Q-learning that replays remembered transitions, drawn from the stream.
    DynaQ(Transitions, Stream),
}

impl Algorithm {
    /// What is remembered, by algorithms with a model.
    fn memory(&self) -> Option<&Transitions> {
        match self {
            Self::DynaQ(memory, _) => Some(memory),
            Self::QLearning | Self::SarsaLambda(_) => None,
        }
    }

    /// Does its memory, if it has one, name what it should?
    fn is_sound(&self) -> bool {
        self.memory().is_none_or(Transitions::is_sound)
    }
}

/// The methods `q-learning`, `sarsa-lambda` and `dyna-q`.
#[derive(Debug, Clone)]
pub struct Tabular {
    algorithm: Algorithm,
    params: Params,
    own: TabularParams,
    table: Table,
    /// The percept under consideration.
    percept: Option<Percept>,
    /// The last step.
    pending: Option<Pending>,
}

/// A step before it is known what came after it.
#[derive(Debug, Clone, Copy)]
struct Pending {
    percept: Percept,
    action: Action,
    reward: f64,
}

impl Tabular {
    /// Q-learning, for `actions` actions. All parameters must have been checked.
    pub fn q_learning(actions: usize, params: Params, own: TabularParams) -> Self {
        Self::new(Algorithm::QLearning, actions, params, own)
    }

    /// Sarsa(lambda).
    pub fn sarsa_lambda(actions: usize, params: Params, own: TabularParams) -> Self {
        let algorithm = Algorithm::SarsaLambda(Traces::default());
        Self::new(algorithm, actions, params, own)
    }

    /// Dyna-Q, which draws what it replays from `stream`.
    pub fn dyna_q(actions: usize, params: Params, own: TabularParams, stream: Stream) -> Self {
        let algorithm = Algorithm::DynaQ(Transitions::default(), stream);
        Self::new(algorithm, actions, params, own)
    }

    fn new(algorithm: Algorithm, actions: usize, params: Params, own: TabularParams) -> Self {
        Self {
            algorithm,
            params,
            own,
            table: Table::new(actions),
            percept: None,
            pending: None,
        }
    }

    /// Goes on with an algorithm and a table from a file; `None` if they are another algorithm's, or damaged.
    fn going_on(mut self, (algorithm, table): (Algorithm, Rows)) -> Option<Self> {
        let is_same = discriminant(&self.algorithm) == discriminant(&algorithm);
        let fits = is_same && algorithm.is_sound();
        self.algorithm = Some(algorithm).filter(|_| fits)?;
        self.table = Table::with_rows(self.table.actions(), table)?;
        Some(self)
    }

    /// Learns the pending step, now that it is known what came after it.
    fn learn(&mut self, next: Option<Percept>, next_action: Option<Action>) {
        let Some(Pending {
            percept,
            action,
            reward,
        }) = self.pending.take()
        else {
            return;
        };
        let step = Transition {
            percept,
            action,
            reward,
            next,
        };
        let (alpha, gamma) = (self.own.alpha, self.params.gamma);
        match &mut self.algorithm {
            Algorithm::QLearning => self.table.q_update(&step, alpha, gamma),
            Algorithm::SarsaLambda(traces) => {
                let decay = self.own.lambda * gamma;
                traces.learn(&mut self.table, &step, next_action, [alpha, gamma, decay]);
            }
            Algorithm::DynaQ(memory, _) => {
                memory.learn(&step, 1);
                self.table.q_update(&step, alpha, gamma);
                self.replay();
            }
        }
    }

    /// Dyna-Q: learns remembered transitions again.
    fn replay(&mut self) {
        let Algorithm::DynaQ(memory, stream) = &mut self.algorithm else {
            return;
        };
        let (alpha, gamma) = (self.own.alpha, self.params.gamma);
        for _ in 0..self.own.replays {
            let Some(recalled) = memory.recall(stream) else {
                return;
            };
            self.table.q_update(&recalled, alpha, gamma);
        }
    }
}

impl Agent for Tabular {
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        if !matches!(self.algorithm, Algorithm::SarsaLambda(_)) {
            self.learn(Some(*percept), None);
        }
        self.percept = Some(*percept);
        self.table.values(percept)
    }

    fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let (action, explores) = explorer.choose(values);
        Choice::of_a_table(action, explores)
    }

    fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let percept = self.percept.expect("consider comes before credit");
        if matches!(self.algorithm, Algorithm::SarsaLambda(_)) {
            self.learn(Some(percept), Some(action));
        }
        let short_term_reward = self.params.short_term(outcome);
        self.pending = Some(Pending {
            percept,
            action,
            reward: short_term_reward,
        });
        StepCredit {
            short_term_reward,
            ..StepCredit::default()
        }
    }

    /// What came after the last step of a failure was never perceived, so it is not learned.
    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        let long_term_reward = if reached_goal { self.params.goal } else { 0.0 };
        if reached_goal {
            self.pending
                .iter_mut()
                .for_each(|last| last.reward += long_term_reward);
            self.learn(None, None);
        }
        self.pending = None;
        if let Algorithm::SarsaLambda(traces) = &mut self.algorithm {
            traces.clear();
        }
        EndCredit {
            long_term_reward,
            learning_rate: self.own.alpha,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        self.params.step_threshold
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.table.values(percept)
    }

    fn knowledge(&self) -> Knowledge {
        self.table.knowledge()
    }

    fn rule_count(&self) -> usize {
        self.table.len()
    }

    fn checkpoint(&self) -> Vec<u8> {
        saved::bytes_of(&(&self.algorithm, self.table.rows()))
    }

    fn restore(&self, saved: &[u8]) -> Result<Box<dyn Agent>, RestoreError> {
        let method = self.clone().going_on(saved::read(saved)?);
        Ok(Box::new(method.ok_or(RestoreError::Foreign)?))
    }
}
