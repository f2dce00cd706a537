//! The short-term reward filter (Alg. 1).

use crate::reward::params::Params;
use crate::xcs::{ActionSet, Xcs};

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

    /// Alg. 1: up to the threshold theta_rs, \[A\] is updated toward its worth plus the reward.
    /// As printed, repeated collisions have no floor.
    pub fn answer(&self, xcs: &mut Xcs, set: &ActionSet, reward: f64) {
        if !self.on || reward > self.threshold {
            return;
        }
        let Some(worth) = xcs.worth(&set.percept).get(set.action) else {
            return;
        };
        let beta = xcs.params().beta;
        xcs.update(set, worth + reward, beta);
    }
}
