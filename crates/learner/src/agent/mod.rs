//! Who learns: an [`Agent`] decides who is credited, with what, and when.
//!
//! [`Method`] is the closed set of agents, by the names they have on the command line. `credit/` has standard XCS
//! and the paper's mechanisms, one file each. `xcscr-plus` and `r-max` are compositions (`composed`) of a state
//! estimator, a model (`model/`), a planner and a policy (`policy/`). `tabular/` has the baselines with a table. All
//! reward numbers live here.

mod choice;
mod composed;
mod credit;
mod estimator;
mod explorer;
mod frozen;
mod knowledge;
mod map_learner;
mod saved;
mod method;
mod model;
mod params;
mod percept_learner;
mod planner;
mod plus_params;
pub mod pomdp;
mod policy;
mod power;
mod tabular;

pub use choice::{Choice, Chooser, Chosen};
use credit::{Combined, Standard};
pub use estimator::map::{
    BEGUN_ELSEWHERE, CONTEXT_BITS, MISLOCALISED, Map, MapParams, MotionPrior, PERCEPT_BITS,
    words as memory_words,
};
pub use explorer::Explorer;
pub use frozen::Frozen;
pub use knowledge::Knowledge;
pub use knowledge::Misfit;
pub use method::{Method, Setup};
pub use model::{CollisionRule, Generalisation, ReturnRule};
pub use params::{Params, Sharing, StackEvolution, StepLimitUpdate, XcsPayment};
pub use plus_params::{Estimator, PlusParams};
pub use policy::contexts::contexts;
pub use policy::demands::{Demand, Part, demands};
pub use power::power;
pub use saved::RestoreError;
use tabular::Tabular;
pub use tabular::TabularParams;

use xcs::{Action, Condition, Percept, PredictionArray};
use xcscr_robot::arena::Outcome;

/// What a reward method made of one step.
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
    /// The condition of the rule of \[A\] that weighs most; `None` where no rule advocates the
    /// action.
    pub fired: Option<Condition>,
}

/// What a reward method made of the end of an episode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndCredit {
    /// The long-term reward r_l.
    pub long_term_reward: f64,
    /// The learning rate with which it was learned.
    pub learning_rate: f64,
    /// Was a policy of \[PS\] imprinted?
    pub imprinted: bool,
}

/// A learner and its way of deciding who is credited, with what, and when.
///
/// Each episode opens with [`begin_episode`](Self::begin_episode). For each step come
/// [`observe`](Self::observe), [`choose`](Self::choose) and [`update`](Self::update), at the end
/// of the episode [`end_episode`](Self::end_episode).
pub trait Agent {
    /// Opens an episode; `evolves`: may rules be discovered by the GA in it? They may until this
    /// is said for the first time. Methods without a GA need not listen.
    fn begin_episode(&mut self, evolves: bool) {
        let _ = evolves;
    }

    /// The value of each action under a percept, as a step of learning: forms \[M\] and covers
    /// missing actions.
    fn observe(&mut self, percept: &Percept) -> PredictionArray;

    /// Chooses an action: by default, any action with probability p_explr, otherwise one of the
    /// best by the rules.
    fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let (action, explores) = explorer.choose(values);
        Choice::of_rules(action, explores)
    }

    /// Credits the action chosen after the last [`observe`](Self::observe).
    fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit;

    /// Ends the episode: `reached_goal` tells a success from a step limit.
    fn end_episode(&mut self, reached_goal: bool) -> EndCredit;

    /// The most steps that the next episode may take.
    fn step_threshold(&self) -> u32;

    /// The value of each action under a percept, without changing anything.
    fn values(&self, percept: &Percept) -> PredictionArray;

    /// What was learned so far.
    fn knowledge(&self) -> Knowledge;

    /// Starts from what was learned in another world, before the first episode; `false` if the
    /// method has no use for it.
    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        let _ = knowledge;
        false
    }

    /// Does what it does in a percept depend on what came before it in the episode?
    fn remembers(&self) -> bool {
        false
    }

    /// Macro-classifiers in \[P\], or stored pairs of a tabular method.
    fn rule_count(&self) -> usize;

    /// All that the method keeps from one episode to the next, for [`restore`](Self::restore);
    /// nothing by default.
    fn checkpoint(&self) -> Vec<u8> {
        Vec::new()
    }

    /// The method that goes on as the one whose [`checkpoint`](Self::checkpoint) this is. `self` must have
    /// been made with the same settings.
    ///
    /// # Errors
    /// When the memory is that of another method or of other settings, or is damaged; by default, always.
    fn restore(&self, saved: &[u8]) -> Result<Box<dyn Agent>, RestoreError> {
        let _ = saved;
        Err(RestoreError::Foreign)
    }
}
