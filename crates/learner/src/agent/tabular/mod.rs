//! Tabular baselines on the same percepts, as controls for the rule learners.

mod params;
mod table;
mod traces;

pub use params::TabularParams;

use table::Table;
use traces::Traces;

use crate::agent::credit::params::Params;
use crate::agent::explorer::Explorer;
use crate::agent::knowledge::Knowledge;
use crate::agent::model::transitions::{Experience, Transitions};
use crate::agent::{Agent, Choice, DecisionSource, EndCredit, StepCredit, Transition};
use xcs::PredictionArray;
use xcs::random::Stream;
use xcs::{Action, Percept};
use xcscr_robot::arena::Outcome;

/// The algorithms that learn a table of values (Sutton and Barto 2018).
#[derive(Debug, Clone)]
pub(in crate::agent) enum Algorithm {
    /// Learns toward the reward plus the best next value.
    QLearning,
    /// Learns toward the reward plus the value of the next action actually chosen.
    SarsaLambda(Traces),
    /// Q-learning that replays remembered transitions, drawn from the stream.
    DynaQ(Transitions, Stream),
}

impl Algorithm {
    /// Creates Sarsa(lambda).
    pub fn sarsa_lambda() -> Self {
        Self::SarsaLambda(Traces::default())
    }

    /// Creates Dyna-Q, which draws the transitions to replay from `stream`.
    pub fn dyna_q(stream: Stream) -> Self {
        Self::DynaQ(Transitions::default(), stream)
    }
}

/// The methods `q-learning`, `sarsa-lambda` and `dyna-q`.
#[derive(Debug, Clone)]
pub struct Tabular {
    algorithm: Algorithm,
    params: Params,
    own: TabularParams,
    table: Table,
    /// The last step, until it is learned.
    pending: Option<Experience>,
}

impl Tabular {
    /// Creates an untrained learner for `actions` actions. All parameters must have been checked.
    pub fn new(algorithm: Algorithm, actions: usize, params: Params, own: TabularParams) -> Self {
        Self {
            algorithm,
            params,
            own,
            table: Table::new(actions),
            pending: None,
        }
    }

    /// Learns the pending step, once its successor is known.
    fn learn(&mut self, next: Option<Percept>, next_action: Option<Action>) {
        let Some(pending) = self.pending.take() else {
            return;
        };
        let step = Experience { next, ..pending };
        let (alpha, gamma) = (self.own.alpha, self.params.gamma);
        match &mut self.algorithm {
            Algorithm::QLearning => self.table.q_update(&step, alpha, gamma),
            Algorithm::SarsaLambda(traces) => {
                let decay = self.own.lambda * gamma;
                traces.learn(&mut self.table, &step, next_action, [alpha, gamma, decay]);
            }
            Algorithm::DynaQ(model, _) => {
                model.learn(&step, 1);
                self.table.q_update(&step, alpha, gamma);
                self.replay();
            }
        }
    }

    /// Dyna-Q: learns remembered transitions again.
    fn replay(&mut self) {
        let Algorithm::DynaQ(model, stream) = &mut self.algorithm else {
            return;
        };
        let (alpha, gamma) = (self.own.alpha, self.params.gamma);
        for _ in 0..self.own.replays {
            let Some(recalled) = model.recall(stream) else {
                return;
            };
            self.table.q_update(&recalled, alpha, gamma);
        }
    }
}

impl Agent for Tabular {
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.table.values(percept)
    }

    fn choose(&mut self, _: &Percept, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let (action, explores) = explorer.choose(values);
        Choice::by(DecisionSource::Table, action, explores)
    }

    fn update(&mut self, step: &Transition<'_>) -> StepCredit {
        let (percept, action) = (*step.percept, step.action);
        let is_sarsa = matches!(self.algorithm, Algorithm::SarsaLambda(_));
        if is_sarsa {
            self.learn(Some(percept), Some(action));
        }
        let short_term_reward = self.params.short_term(step.outcome);
        let goal = if step.outcome == Outcome::ReachedGoal {
            self.params.goal
        } else {
            0.0
        };
        self.pending = Some(Experience {
            percept,
            action,
            reward: short_term_reward + goal,
            next: None,
        });
        // Sarsa learns a step when the next action is known.
        if !is_sarsa || step.next.is_none() {
            self.learn(step.next.copied(), None);
        }
        StepCredit {
            short_term_reward,
            ..StepCredit::default()
        }
    }

    /// Ends the episode. Sarsa does not learn the last step before a step limit, because no action follows.
    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        self.pending = None;
        if let Algorithm::SarsaLambda(traces) = &mut self.algorithm {
            traces.clear();
        }
        let long_term_reward = if reached_goal { self.params.goal } else { 0.0 };
        EndCredit::new(long_term_reward, self.own.alpha)
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
}
