//! Tabular rivals on the same percepts, so that every claim about rules has its control.

mod foretelling;
mod params;
mod planned;
mod table;
mod traces;

pub use params::TabularParams;

use std::mem::discriminant;

use serde::{Deserialize, Serialize};

use foretelling::{Foretelling, Kept};
use planned::Planned;
use table::{Rows, Table};
use traces::Traces;

use super::explorer::Explorer;
use super::knowledge::Knowledge;
use super::memory::{self, MemoryError};
use super::model::planner::{Belief, Planner};
use super::model::transitions::{Transition, Transitions};
use super::params::Params;
use super::{Agent, Choice, EndCredit, StepCredit};
use crate::arena::Outcome;
use xcs::PredictionArray;
use xcs::random::Stream;
use xcs::{Action, Percept};

/// How a table of values is learned (Sutton and Barto 2018; R-max: Brafman and Tennenholtz 2002).
#[derive(Debug, Clone, Serialize, Deserialize)]
enum Algorithm {
    /// Toward the reward plus the best value after it.
    QLearning,
    /// Toward the reward plus the value of the action that was really chosen after it.
    SarsaLambda(Traces),
    /// Q-learning that replays remembered transitions, drawn from the stream.
    DynaQ(Transitions, Stream),
    /// Values planned on a model that takes the unknown for the best.
    RMax(Transitions),
}

impl Algorithm {
    /// What is remembered, by algorithms with a model.
    fn memory(&self) -> Option<&Transitions> {
        match self {
            Self::DynaQ(memory, _) | Self::RMax(memory) => Some(memory),
            Self::QLearning | Self::SarsaLambda(_) => None,
        }
    }

    /// Does its memory, if it has one, name what it should?
    fn is_sound(&self) -> bool {
        self.memory().is_none_or(Transitions::is_sound)
    }
}

/// The methods `q-learning`, `sarsa-lambda`, `dyna-q` and `r-max`.
#[derive(Debug, Clone)]
pub struct Tabular {
    algorithm: Algorithm,
    params: Params,
    own: TabularParams,
    table: Table,
    /// What foretells collisions and ways back, in methods with a model.
    foretelling: Option<Foretelling>,
    /// What the greedy policy follows, where that is not `table`.
    policy: Option<Planned>,
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
    bumped: bool,
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

    /// R-max.
    pub fn r_max(actions: usize, params: Params, own: TabularParams) -> Self {
        Self::new(
            Algorithm::RMax(Transitions::default()),
            actions,
            params,
            own,
        )
    }

    fn new(algorithm: Algorithm, actions: usize, params: Params, own: TabularParams) -> Self {
        Self {
            algorithm,
            params,
            own,
            table: Table::new(actions),
            foretelling: None,
            policy: None,
            percept: None,
            pending: None,
        }
    }

    /// The same with the foresight of `xcscr-plus`, for percepts whose first `ring` bits lie in a
    /// ring around the robot; `certainty` is `plus.certainty`.
    pub fn with_foresight(mut self, ring: usize, certainty: u32) -> Self {
        self.foretelling = Some(Foretelling::new(self.table.actions(), ring, certainty));
        self
    }

    /// Goes on with an algorithm, tables and foresight from a file; `None` if they are another
    /// algorithm's, or damaged.
    fn going_on(
        mut self,
        (algorithm, table, policy, foretelling): (Algorithm, Rows, Option<Rows>, Option<Kept>),
    ) -> Option<Self> {
        let is_same = discriminant(&self.algorithm) == discriminant(&algorithm);
        let fits = is_same && algorithm.is_sound();
        self.algorithm = Some(algorithm).filter(|_| fits)?;
        let actions = self.table.actions();
        self.table = Table::with_rows(actions, table)?;
        self.policy = match policy {
            Some(rows) => Some(Table::with_rows(actions, rows)?.into()),
            None => None,
        };
        let met = self.algorithm.memory().map_or(0, |it| it.percepts().len());
        let resumed = match (&mut self.foretelling, foretelling) {
            (Some(own), Some(kept)) => own.resume(kept, met),
            (own, kept) => own.is_none() && kept.is_none(),
        };
        resumed.then_some(self)
    }

    /// Learns the pending step, now that it is known what came after it.
    fn learn(&mut self, next: Option<Percept>, next_action: Option<Action>) {
        let Some(Pending {
            percept,
            action,
            reward,
            bumped,
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
                if let Some(foretelling) = &mut self.foretelling {
                    foretelling.learn(memory, &step, bumped);
                }
                self.table.q_update(&step, alpha, gamma);
                self.replay();
            }
            Algorithm::RMax(memory) => {
                let mut news = memory.learn(&step, self.own.known_after);
                if let Some(foretelling) = &mut self.foretelling {
                    news |= foretelling.learn(memory, &step, bumped);
                }
                if news {
                    self.plan();
                }
            }
        }
    }

    /// Dyna-Q: learns remembered transitions again, and with each what is foretold where it began.
    fn replay(&mut self) {
        let Algorithm::DynaQ(memory, stream) = &mut self.algorithm else {
            return;
        };
        let (alpha, gamma) = (self.own.alpha, self.params.gamma);
        let actions = self.table.actions();
        for _ in 0..self.own.replays {
            let Some(recalled) = memory.recall(stream) else {
                return;
            };
            self.table.q_update(&recalled, alpha, gamma);
            if let Some(foretelling) = &self.foretelling {
                let number = memory.meet(&recalled.percept);
                for step in foretelling.foretold(memory, number, actions, &self.params) {
                    self.table.q_update(&step, alpha, gamma);
                }
            }
        }
    }

    /// R-max: plans again on what is remembered.
    fn plan(&mut self) {
        let Algorithm::RMax(memory) = &self.algorithm else {
            return;
        };
        let actions = self.table.actions();
        let planner = Planner {
            actions,
            known_after: self.own.known_after,
            gamma: self.params.gamma,
            collision: self.params.collision,
        };
        let problem = planner.problem(memory, |percept, action| match &self.foretelling {
            Some(it) => it.belief(memory, (percept, action), &self.params),
            None => Belief::Bumps(0.0),
        });
        let values = problem.solve(self.params.goal);
        self.table = Table::from_values(memory, &values, actions);
        self.policy = (!self.own.optimistic_policy).then(|| Planned::on(problem));
    }

    /// What the greedy policy follows.
    fn followed(&self) -> &Table {
        match (&self.policy, self.algorithm.memory()) {
            (Some(policy), Some(memory)) => policy.table(memory, self.table.actions()),
            _ => &self.table,
        }
    }
}

impl Agent for Tabular {
    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        if !matches!(self.algorithm, Algorithm::SarsaLambda(_)) {
            self.learn(Some(*percept), None);
        }
        self.percept = Some(*percept);
        self.table.worth(percept)
    }

    /// R-max explores by its optimism alone.
    fn choose(&mut self, worth: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let (action, explores) = match self.algorithm {
            Algorithm::RMax(_) => (explorer.exploit(worth), false),
            _ => explorer.choose(worth),
        };
        Choice::of_a_table(action, explores)
    }

    fn credit(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let percept = self.percept.expect("consider comes before credit");
        if matches!(self.algorithm, Algorithm::SarsaLambda(_)) {
            self.learn(Some(percept), Some(action));
        }
        let short_term_reward = self.params.short_term(outcome);
        let bumped = matches!(outcome, Outcome::Collided { .. });
        if let Some(foretelling) = &mut self.foretelling {
            foretelling.learn_bump(&percept, action, bumped);
        }
        self.pending = Some(Pending {
            percept,
            action,
            reward: short_term_reward,
            bumped,
        });
        StepCredit {
            short_term_reward,
            ..StepCredit::default()
        }
    }

    /// What came after the last step of a failure was never perceived, so it is not learned.
    fn finish(&mut self, reached_goal: bool) -> EndCredit {
        let long_term_reward = if reached_goal { self.params.goal } else { 0.0 };
        if reached_goal {
            self.pending
                .iter_mut()
                .for_each(|last| last.reward += long_term_reward);
            self.learn(None, None);
        }
        self.pending = None;
        if let Some(foretelling) = &mut self.foretelling {
            foretelling.begin();
        }
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

    fn worth(&self, percept: &Percept) -> PredictionArray {
        self.followed().worth(percept)
    }

    fn knowledge(&self) -> Knowledge {
        self.followed().knowledge()
    }

    fn rule_count(&self) -> usize {
        self.table.len()
    }

    fn memory(&self) -> Vec<u8> {
        let policy = self.policy.as_ref().map(|_| self.followed().rows());
        let foretelling = self.foretelling.as_ref().map(Foretelling::kept);
        memory::of(&(&self.algorithm, self.table.rows(), policy, foretelling))
    }

    fn restored(&self, saved: &[u8]) -> Result<Box<dyn Agent>, MemoryError> {
        let method = self.clone().going_on(memory::recall(saved)?);
        Ok(Box::new(method.ok_or(MemoryError::Foreign)?))
    }
}
