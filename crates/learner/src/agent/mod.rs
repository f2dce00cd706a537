//! Learners. An [`Agent`] chooses actions and learns from their outcomes; [`Method`] names all agents.
//!
//! * `credit/`: the XCS family, one mechanism a file, and all reward numbers ([`Params`]).
//! * `estimator/`: the state is the percept, or a cell of a learned map, tracked by a Bayes filter.
//! * `model/`: what follows an action. Counted transitions, rules that generalise them, and a POMDP.
//! * `planner/`: prioritised sweeping over percepts, RTDP-Bel over beliefs, and exploration for both.
//! * `policy/`: distilled rules, a plan, or random exploration.
//! * `composed/`: `xcscr-plus` and `r-max`, made of an estimator, a model, a planner and a policy.
//! * `tabular/`: the baselines with a table.
//! * `knowledge/`: the form of what was learned, and an agent that only follows it.
//!
//! A folder uses only those above it in the order model, estimator, planner, policy, composed.

mod composed;
mod credit;
pub(crate) mod estimator;
mod knowledge;
mod method;
pub(crate) mod model;
pub(crate) mod planner;
mod policy;
mod tabular;

pub use composed::{EnvironmentLearner, EnvironmentParams, PlusParams};
pub use credit::{Params, Sharing, StackEvolution, StepLimitUpdate, XcsPayment};
pub use estimator::Estimator;
pub use estimator::belief::NEGLIGIBLE_PROBABILITY;
pub use estimator::map::{
    BEGUN_ELSEWHERE, CONTEXT_BITS, MISLOCALISED, Map, MapParams, MotionPrior, PERCEPT_BITS,
};
pub use knowledge::{Frozen, Knowledge, Misfit};
pub use method::{Method, Setup};
pub use model::pomdp::GOAL;
pub use model::power::power;
pub use model::{CollisionRule, Generalisation, InverseActionRule};
pub use planner::rtdp_bel::MOST_BELIEFS;
pub use policy::choice::{Choice, Chosen, DecisionSource};
pub use policy::contexts::contexts;
pub(crate) use policy::demands::words as context_words;
pub use policy::demands::{Demand, Part, demands};
pub use policy::explorer::Explorer;
pub use tabular::TabularParams;

use xcs::{Action, Condition, Percept, PredictionArray};
use xcscr_robot::arena::Outcome;

/// The credit of one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StepCredit {
    /// The short-term reward r_s.
    pub short_term_reward: f64,
    /// Fitness-weighted mean prediction error of \[A\]; 0 for tabular methods.
    pub error: f64,
    /// Micro-classifiers in \[M\]; 0 for tabular methods.
    pub match_set: u32,
    /// Micro-classifiers in \[A\]; 0 for tabular methods.
    pub action_set: u32,
    /// The condition of the rule of \[A\] with the greatest weight; `None` if no rule advocates the
    /// action.
    pub fired: Option<Condition>,
}

/// The credit at the end of an episode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndCredit {
    /// The long-term reward r_l.
    pub long_term_reward: f64,
    /// The learning rate used for it.
    pub learning_rate: f64,
    /// True if a policy of \[PS\] was imprinted.
    pub imprinted: bool,
}

impl EndCredit {
    /// Creates the credit of an episode after which no policy was imprinted.
    pub fn new(long_term_reward: f64, learning_rate: f64) -> Self {
        Self {
            long_term_reward,
            learning_rate,
            imprinted: false,
        }
    }
}

/// A learner with its credit assignment.
///
/// Each episode begins with [`begin_episode`](Self::begin_episode). Each step calls
/// [`observe`](Self::observe), [`choose`](Self::choose) and [`update`](Self::update). The episode
/// ends with [`end_episode`](Self::end_episode).
pub trait Agent {
    /// Begins an episode. `evolves` says whether the GA may discover rules in it; before the first
    /// call it may. Methods without a GA can ignore the call.
    fn begin_episode(&mut self, evolves: bool) {
        let _ = evolves;
    }

    /// Returns the value of each action in a percept, as a step of learning: forms \[M\] and covers
    /// missing actions.
    fn observe(&mut self, percept: &Percept) -> PredictionArray;

    /// Chooses an action. By default: any action with probability p_explr, otherwise one of the
    /// best according to the rules.
    fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let (action, explores) = explorer.choose(values);
        Choice::by(DecisionSource::Rules, action, explores)
    }

    /// Credits the action chosen after the last [`observe`](Self::observe).
    fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit;

    /// Ends the episode. `reached_goal` is false after a step limit.
    fn end_episode(&mut self, reached_goal: bool) -> EndCredit;

    /// Returns the maximum number of steps of the next episode.
    fn step_threshold(&self) -> u32;

    /// Returns the value of each action in a percept, without changing anything.
    fn values(&self, percept: &Percept) -> PredictionArray;

    /// Returns what was learned so far.
    fn knowledge(&self) -> Knowledge;

    /// Initialises the learner with knowledge from another world, before the first episode; `false`
    /// if the method cannot use it.
    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        let _ = knowledge;
        false
    }

    /// Returns true if choices depend on earlier steps of the episode.
    fn remembers(&self) -> bool {
        false
    }

    /// Returns the number of macro-classifiers in \[P\], or of stored pairs of a tabular method.
    fn rule_count(&self) -> usize;
}
