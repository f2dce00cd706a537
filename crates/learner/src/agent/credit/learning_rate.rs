//! The learning-rate switching mechanism (paper, section III-C).

use crate::agent::credit::params::Params;

/// The learning rates for collisions and for the ends of episodes.
#[derive(Debug, Clone)]
pub(super) struct LearningRate {
    success: f64,
    failure: f64,
    collision: f64,
}

impl LearningRate {
    /// Creates the learning rates. With switching off, all rates are `beta`.
    pub fn new(params: &Params, beta: f64) -> Self {
        if params.learning_rate_switching {
            Self {
                success: params.beta_success,
                failure: params.beta_failure,
                collision: params.beta_collision,
            }
        } else {
            Self {
                success: beta,
                failure: beta,
                collision: beta,
            }
        }
    }

    /// Returns the rate after a success or a failure.
    pub fn after(&self, reached_goal: bool) -> f64 {
        if reached_goal {
            self.success
        } else {
            self.failure
        }
    }

    /// Returns the rate of the short-term filter.
    pub fn after_collision(&self) -> f64 {
        self.collision
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn success_is_learned_fast_and_failure_slowly() {
        let rate = LearningRate::new(&Params::default(), 0.1);
        assert_eq!((rate.after(true), rate.after(false)), (0.2, 0.05));
    }

    #[test]
    fn a_collision_is_learned_fast_unless_it_counts_as_a_punishment() {
        let rate = |params: &Params| LearningRate::new(params, 0.1).after_collision();
        assert_eq!(rate(&Params::default()), 0.2);
        let punishment = Params {
            beta_collision: 0.05,
            ..Params::default()
        };
        assert_eq!(rate(&punishment), 0.05);
    }

    #[test]
    fn all_rates_are_equal_when_switched_off() {
        let params = Params {
            learning_rate_switching: false,
            ..Params::default()
        };
        let rate = LearningRate::new(&params, 0.1);
        assert_eq!((rate.after(true), rate.after(false)), (0.1, 0.1));
        assert_eq!(rate.after_collision(), 0.1);
    }
}
