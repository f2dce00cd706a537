//! The short-term reward filter (Alg. 1).

use crate::agent::credit::params::Params;
use xcs::{ActionSet, Xcs};

/// Applies severe short-term rewards at once, and only to the rules that caused them.
#[derive(Debug, Clone)]
pub(super) struct ShortTermFilter {
    on: bool,
    threshold: f64,
}

impl ShortTermFilter {
    pub fn new(params: &Params) -> Self {
        Self {
            on: params.short_term_filter,
            threshold: params.theta_rs,
        }
    }

    /// Alg. 1: if the reward is at most theta_rs, updates \[A\] toward its value plus the reward,
    /// at learning rate `beta`. As printed in the paper, repeated collisions have no lower bound.
    /// Returns the value of the action before and after; `None` if the filter did not fire.
    pub fn apply(
        &self,
        xcs: &mut Xcs,
        set: &ActionSet,
        reward: f64,
        beta: f64,
    ) -> Option<[f64; 2]> {
        if !self.on || reward > self.threshold {
            return None;
        }
        let value = |xcs: &Xcs| xcs.values(&set.percept).get(set.action);
        let before = value(xcs)?;
        xcs.update(set, before + reward, beta);
        Some([before, value(xcs).unwrap_or(before)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcs::Action;
    use xcs::random::Stream;
    use xcs::{self, MatchSet};
    use xcscr_robot::streams::StreamName;

    /// Returns the values of two actions in one percept after a reward was applied twice to the
    /// first.
    fn values_after(reward: f64, params: &Params) -> [Option<f64>; 2] {
        let percept = "0110".parse().unwrap();
        let stream = Stream::new(1, StreamName::Evolution);
        let mut xcs = Xcs::new(xcs::Params::default(), 2, stream);
        let mut set = MatchSet::default();
        xcs.form_match_set(&percept, &mut set);
        let chosen = set.action_set(Action::new(0).unwrap()).unwrap();
        let filter = ShortTermFilter::new(params);
        filter.apply(&mut xcs, &chosen, reward, 0.2);
        filter.apply(&mut xcs, &chosen, reward, 0.2);
        [0, 1].map(|i| xcs.values(&percept).get(Action::new(i).unwrap()))
    }

    #[test]
    fn algorithm_1_lowers_the_value_of_the_colliding_action_only() {
        // First update of a new rule: all the way to 0 - 50. Second: the mean of -50 and (-50 - 50)
        // is -75.
        assert_eq!(
            values_after(-50.0, &Params::default()),
            [Some(-75.0), Some(0.0)]
        );
    }

    #[test]
    fn algorithm_1_ignores_rewards_above_the_threshold() {
        assert_eq!(values_after(-1.0, &Params::default()), [Some(0.0); 2]);
    }

    #[test]
    fn it_does_nothing_when_switched_off() {
        let params = Params {
            short_term_filter: false,
            ..Params::default()
        };
        assert_eq!(values_after(-50.0, &params), [Some(0.0); 2]);
    }
}
