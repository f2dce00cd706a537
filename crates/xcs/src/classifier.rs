//! A rule: condition, action, and what is known of them.

use serde::{Deserialize, Serialize};

use super::condition::Condition;
use super::params::Params;
use super::representation::Representation;
use crate::signal::Action;

/// A macro-classifier: `numerosity` identical rules that share their figures.
///
/// The condition comes first, and what a learning step needs lies together behind it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound = "C: Representation")]
pub struct Classifier<C = Condition> {
    /// Which percepts it matches.
    pub condition: C,
    /// What it advocates.
    #[serde(deserialize_with = "Action::read::<C, _>")]
    pub action: Action,
    /// p: the expected payoff.
    pub prediction: f64,
    /// epsilon: the mean deviation of the payoff from the prediction.
    pub error: f64,
    /// F: accuracy relative to the action sets it took part in, of all `numerosity` together.
    pub fitness: f64,
    /// num: the micro-classifiers it stands for; at least 1.
    pub numerosity: u32,
    /// exp: how often it was updated; stops counting at the greatest number.
    pub experience: u32,
    /// ts: the step of the last run of the GA in a set it belonged to.
    pub time_stamp: u64,
    /// as: the mean number of micro-classifiers in the action sets it took part in.
    pub set_size: f64,
    /// eam: how many actions its niche needs, in XCSAM: from 1, where its action is the best, to
    /// the number of actions, where it is not. 1 in all other methods. Files of rules leave it
    /// out, because what is best in one world is not in another; memories of learners hold it.
    #[serde(skip, default = "no_mapping")]
    pub eam: f32,
}

/// eam where the mapping does not adapt.
fn no_mapping() -> f32 {
    1.0
}

impl<C: Representation> Classifier<C> {
    /// A covering rule, which knows nothing yet.
    pub fn new(condition: C, action: Action, time: u64, params: &Params) -> Self {
        Self {
            condition,
            action,
            prediction: params.initial_prediction,
            error: params.initial_error,
            fitness: params.initial_fitness,
            numerosity: 1,
            experience: 0,
            time_stamp: time,
            set_size: 1.0,
            eam: no_mapping(),
        }
    }

    /// kappa, the accuracy (Eq. 3 of the paper misses alpha and the sign of nu; this is Butz and
    /// Wilson's form): 1 up to epsilon_0, then `alpha (epsilon / epsilon_0)^-nu`.
    pub fn accuracy(&self, params: &Params) -> f64 {
        if self.error <= params.epsilon_0 {
            return 1.0;
        }
        let ratio = params.epsilon_0 / self.error;
        params.alpha * (0..params.nu).fold(1.0, |power, _| power * ratio)
    }

    /// Is it experienced and accurate enough to subsume others?
    pub fn could_subsume(&self, params: &Params) -> bool {
        self.experience > params.theta_sub && self.error < params.epsilon_0
    }

    /// Does it make `other` superfluous: same action, more general, and able to subsume?
    pub fn subsumes(&self, other: &Self, params: &Params) -> bool {
        self.action == other.action
            && self.could_subsume(params)
            && self.condition.is_more_general_than(&other.condition)
    }
}
