//! Learners. An [`Agent`] chooses actions and learns from their outcomes; [`Method`] names all agents.
//!
//! * `credit/`: the XCS family, one mechanism of the paper a file, and all reward numbers ([`Params`]).
//! * `model/`: what follows an action: counted transitions, and rules that generalise them.
//! * `planner/`: prioritised sweeping over percepts, and planned exploration.
//! * `plus/`: `xcscr-plus`, which is XCSCR with a model, a planner and replay; and `r-max`, which is the model alone.
//! * `tabular/`: the baselines with a table.
//! * `knowledge/`: the form of what was learned, and an agent that only follows it.
//! * `with_history.rs`: a percept of the last steps, for any learner.
//!
//! A folder uses only those above it, and `knowledge`.

mod choice;
mod credit;
mod explorer;
mod knowledge;
mod method;
mod model;
mod planner;
mod plus;
mod tabular;
mod with_history;

pub use choice::{Choice, Chosen, DecisionSource};
pub use credit::{Params, Sharing, StackEvolution, StepLimitUpdate, XcsPayment};
pub use explorer::Explorer;
pub use knowledge::{Frozen, Knowledge, Misfit};
pub use method::{Method, Setup};
pub use model::{CollisionRule, Generalisation, InverseActionRule};
pub use plus::PlusParams;
pub use tabular::TabularParams;
pub use with_history::WithHistory;

use xcs::{Action, Condition, Percept, PredictionArray};
use xcscr_robot::arena::Outcome;
use xcscr_robot::sensor::History;
use xcscr_robot::world::Cell;

/// One step in the environment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition<'a> {
    /// The percept in which the action was chosen.
    pub percept: &'a Percept,
    /// The cell in which the action was chosen, as the robot estimates it; `None` in an environment without cells,
    /// where the percept is the place.
    pub place: Option<Cell>,
    /// The chosen action.
    pub action: Action,
    /// The outcome of the action.
    pub outcome: Outcome,
    /// The next percept; `None` at a goal.
    pub next: Option<&'a Percept>,
}

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
    /// The value of the action before and after the short-term filter (Alg. 1); `None` if it did not fire.
    pub filtered: Option<[f64; 2]>,
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

/// How often rules were updated: each update is of one action set.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct RuleUpdates {
    /// Updates with rewards of real steps, or of stored policies.
    pub experience: u64,
    /// Updates with the plan of a learned model, and rules added for it.
    pub model: u64,
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

    /// Chooses an action in the percept of the last [`observe`](Self::observe), which returned `values`. By default: any
    /// action with probability p_explr, otherwise one of the best according to the rules.
    fn choose(
        &mut self,
        percept: &Percept,
        values: &PredictionArray,
        explorer: &mut Explorer,
    ) -> Choice {
        let _ = percept;
        let (action, explores) = explorer.choose(values);
        Choice::by(DecisionSource::Rules, action, explores)
    }

    /// Credits the action chosen after the last [`observe`](Self::observe).
    fn update(&mut self, step: &Transition<'_>) -> StepCredit;

    /// Ends the episode. `reached_goal` is false after a step limit.
    fn end_episode(&mut self, reached_goal: bool) -> EndCredit;

    /// Returns the maximum number of steps of the next episode.
    fn step_threshold(&self) -> u32;

    /// Returns the value of each action in a percept, without changing anything. The percept is followed by the
    /// [`first_history`](Self::first_history).
    fn values(&self, percept: &Percept) -> PredictionArray;

    /// Returns what was learned so far.
    fn knowledge(&self) -> Knowledge;

    /// Initialises the learner with knowledge from another world, before the first episode; `false`
    /// if the method cannot use it.
    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        let _ = knowledge;
        false
    }

    /// Returns the number of macro-classifiers in \[P\], or of stored pairs of a tabular method.
    fn rule_count(&self) -> usize;

    /// Returns how often rules were updated so far. By default, there are no rules.
    fn rule_updates(&self) -> RuleUpdates {
        RuleUpdates::default()
    }

    /// Returns the history that follows a percept at the beginning of an episode. By default, no steps are kept.
    fn first_history(&self) -> History {
        History::default()
    }
}
