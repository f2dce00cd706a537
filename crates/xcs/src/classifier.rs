//! A rule: its condition, action and statistics.

use serde::{Deserialize, Serialize};

use super::condition::Condition;
use super::params::Params;
use super::representation::Representation;
use crate::action::Action;

/// A macro-classifier: `numerosity` identical rules with shared statistics.
///
/// The fields that a learning step needs are stored together, after the condition.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound = "C: Representation")]
pub struct Classifier<C = Condition> {
    /// The condition that decides which percepts the rule matches.
    pub condition: C,
    /// The advocated action.
    pub action: Action,
    /// p: the expected payoff.
    pub prediction: f64,
    /// epsilon: the mean deviation of the payoff from the prediction.
    pub error: f64,
    /// F: accuracy relative to the action sets the rule took part in, summed over all `numerosity`
    /// micro-classifiers.
    pub fitness: f64,
    /// num: the number of micro-classifiers; at least 1.
    pub numerosity: u32,
    /// exp: the number of updates, saturating.
    pub experience: u32,
    /// ts: the step of the last GA run in a set that contained the rule.
    pub time_stamp: u64,
    /// as: the mean number of micro-classifiers in the action sets the rule took part in.
    pub set_size: f64,
    /// eam: the number of actions that the rule's niche needs in XCSAM. It ranges from 1, where the
    /// rule's action is the best, to the number of actions, where it is not. It is 1 in all other
    /// methods. Rule files omit it, because the best action in one world may not be the best in
    /// another.
    #[serde(skip, default = "no_mapping")]
    pub eam: f32,
}

/// The eam without an adaptive mapping.
fn no_mapping() -> f32 {
    1.0
}

impl<C: Representation> Classifier<C> {
    /// Creates a covering rule without experience.
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

    /// Returns kappa, the accuracy: 1 up to epsilon_0, then `alpha (epsilon / epsilon_0)^-nu`. Eq.
    /// 3 of the paper lacks alpha and the sign of nu; this is Butz and Wilson's form.
    pub fn accuracy(&self, params: &Params) -> f64 {
        if self.error <= params.epsilon_0 {
            return 1.0;
        }
        let ratio = params.epsilon_0 / self.error;
        params.alpha * (0..params.nu).fold(1.0, |power, _| power * ratio)
    }

    /// Returns true if the rule is experienced and accurate enough to subsume others.
    pub fn could_subsume(&self, params: &Params) -> bool {
        self.experience > params.theta_sub && self.error < params.epsilon_0
    }

    /// Returns true if the rule makes `other` redundant: same action, more general, and able to
    /// subsume.
    pub fn subsumes(&self, other: &Self, params: &Params) -> bool {
        self.action == other.action
            && self.could_subsume(params)
            && self.condition.is_more_general_than(&other.condition)
    }
}
