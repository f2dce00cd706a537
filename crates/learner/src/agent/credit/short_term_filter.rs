//! The short-term reward filter (Alg. 1).

use crate::agent::params::Params;
use xcs::{ActionSet, Xcs};

/// Answers severe short-term rewards at once, and only in the rules that caused them.
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

    /// Alg. 1: up to the threshold theta_rs, \[A\] is updated toward its value plus the reward,
    /// at learning rate `beta`. As printed, repeated collisions have no floor.
    pub fn answer(&self, xcs: &mut Xcs, set: &ActionSet, reward: f64, beta: f64) {
        if !self.on || reward > self.threshold {
            return;
        }
        let Some(values) = xcs.values(&set.percept).get(set.action) else {
            return;
        };
        xcs.update(set, values + reward, beta);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcs::Action;
    use xcs::random::Stream;
    use xcs::{self, MatchSet};
    use xcscr_robot::streams::StreamName;

    /// The value of the chosen action (of two, in one percept) after a reward was answered twice.
    fn values_after(reward: f64, params: &Params) -> [Option<f64>; 2] {
        let percept = "0110".parse().unwrap();
        let stream = Stream::new(1, StreamName::Evolution);
        let mut xcs = Xcs::new(xcs::Params::default(), 2, stream);
        let mut set = MatchSet::default();
        xcs.form_match_set(&percept, &mut set);
        let chosen = set.action_set(Action::new(0).unwrap()).unwrap();
        let filter = ShortTermFilter::new(params);
        filter.answer(&mut xcs, &chosen, reward, 0.2);
        filter.answer(&mut xcs, &chosen, reward, 0.2);
        [0, 1].map(|i| xcs.values(&percept).get(Action::new(i).unwrap()))
    }

    #[test]
    fn algorithm_1_lowers_the_worth_of_the_colliding_action_only() {
        // First update of a young rule: all the way to 0 - 50. Second: the mean of -50 and
        // (-50 - 50) is -75.
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
    fn switched_off_it_answers_nothing() {
        let params = Params {
            short_term_filter: false,
            ..Params::default()
        };
        assert_eq!(values_after(-50.0, &params), [Some(0.0); 2]);
    }
}
