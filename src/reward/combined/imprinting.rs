//! The imprinting mechanism (Alg. 2 to 4).

use crate::random::Stream;
use crate::reward::params::Params;
use crate::reward::stack::Shares;
use crate::signal::{Action, Percept};
use crate::xcs::Xcs;

/// A policy as it was executed: the percept and action of each step.
pub(super) type Policy = Vec<(Percept, Action)>;

/// Keeps the best executed policies, and decides when one of them is rehearsed.
#[derive(Debug, Clone)]
pub(super) struct Imprinting {
    on: bool,
    theta_x: f64,
    /// \[PS\]: different policies of the same, shortest length.
    policies: Vec<Policy>,
    stream: Stream,
}

impl Imprinting {
    pub fn new(params: &Params, stream: Stream) -> Self {
        Self {
            on: params.imprinting,
            theta_x: params.theta_x,
            policies: Vec::new(),
            stream,
        }
    }

    /// Alg. 2: a success updates \[PS\]; a failure names, with probability 1 - theta_x, one of its
    /// policies to be rehearsed.
    pub fn after(&mut self, reached_goal: bool, policy: Policy) -> Option<&[(Percept, Action)]> {
        if !self.on {
            return None;
        }
        if reached_goal {
            self.update(policy);
            return None;
        }
        let rehearses = self.stream.unit() > self.theta_x;
        let chosen = self.policies.get(..).filter(|_| rehearses)?;
        self.stream.choose(chosen).map(Vec::as_slice)
    }

    /// Alg. 3: a shorter policy replaces the set, a different one of the same length joins it.
    fn update(&mut self, policy: Policy) {
        let shortest = self.policies.first().map_or(usize::MAX, Vec::len);
        if policy.len() < shortest {
            self.policies = vec![policy];
        } else if policy.len() == shortest && !self.policies.contains(&policy) {
            self.policies.push(policy);
        }
    }
}

/// Alg. 4: every (percept, action) pair of a policy is updated as if the policy had just
/// succeeded, each with its share of the reward.
pub(super) fn clone_behaviour(
    xcs: &mut Xcs,
    policy: &[(Percept, Action)],
    shares: &Shares,
    beta: f64,
) {
    for (back, (percept, action)) in policy.iter().rev().enumerate() {
        let cloned = xcs.matching_action_set(percept, *action);
        xcs.update(&cloned, shares.of_step(back), beta);
    }
}
