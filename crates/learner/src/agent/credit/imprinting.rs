//! The imprinting mechanism (Alg. 2 to 4).

use crate::agent::credit::params::Params;
use crate::agent::credit::policy::{Policy, PolicyStep};
use crate::agent::credit::stack::Shares;
use xcs::Xcs;
use xcs::random::Stream;
use xcs::{Action, Percept};

/// A step of a replayed policy, and its share of the reward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ReplayedStep {
    pub percept: Percept,
    pub action: Action,
    pub share: f64,
}

/// Returns the steps of a policy with their shares, last step first.
pub(super) fn replayed_steps(policy: &[PolicyStep], shares: &Shares) -> Vec<ReplayedStep> {
    let steps = policy.iter().rev().zip(shares.backward());
    steps
        .map(|(step, share)| ReplayedStep {
            percept: step.percept,
            action: step.action,
            share,
        })
        .collect()
}

/// The maximum number of policies in \[PS\]. An open room has many paths of the same length.
const MOST_POLICIES: usize = 1_000;

/// Stores the best executed policies, and decides when one of them is replayed.
#[derive(Debug, Clone)]
pub(super) struct Imprinting {
    on: bool,
    theta_x: f64,
    /// \[PS\]: distinct policies of the same, shortest length, the first [`MOST_POLICIES`].
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

    /// Alg. 2: a success updates \[PS\]. After a failure, returns one of its policies to replay,
    /// with probability 1 - theta_x.
    pub fn after(&mut self, reached_goal: bool, policy: &Policy) -> Option<&Policy> {
        if reached_goal {
            self.store(policy);
            return None;
        }
        self.replayable()?;
        self.stream.choose(&self.policies)
    }

    /// Alg. 2 without the random choice: returns all policies of \[PS\] if one of them is to be
    /// replayed after a failure.
    pub fn replayable(&mut self) -> Option<&[Policy]> {
        let replays = self.on && self.stream.unit() > self.theta_x;
        Some(&self.policies[..]).filter(|all| replays && !all.is_empty())
    }

    /// Returns true if a policy with the same percepts and actions is in \[PS\].
    pub fn contains(&self, policy: &Policy) -> bool {
        let decisions = |policy: &Policy| -> Vec<(Percept, Action)> {
            let steps = policy.iter();
            steps.map(|step| (step.percept, step.action)).collect()
        };
        let wanted = decisions(policy);
        self.policies.iter().any(|known| decisions(known) == wanted)
    }

    /// Alg. 3: a shorter policy replaces the set; a different policy of the same length is added.
    pub fn store(&mut self, policy: &Policy) {
        if !self.on {
            return;
        }
        let shortest = self.policies.first().map_or(usize::MAX, Vec::len);
        if policy.len() < shortest {
            self.policies = vec![policy.clone()];
        } else if policy.len() == shortest
            && self.policies.len() < MOST_POLICIES
            && !self.contains(policy)
        {
            self.policies.push(policy.clone());
        }
    }
}

/// Alg. 4: updates every (percept, action) pair of a policy toward its share of the reward, as if
/// the policy had just succeeded.
pub(super) fn clone_behaviour(xcs: &mut Xcs, replayed_steps: &[ReplayedStep], beta: f64) {
    for step in replayed_steps {
        let cloned = xcs.matching_action_set(&step.percept, step.action);
        xcs.update(&cloned, step.share, beta);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::credit::policy::Place;
    use xcs;
    use xcscr_robot::streams::StreamName;

    /// Returns a policy that takes these actions in as many different percepts.
    fn policy(actions: &[usize]) -> Policy {
        let step = |(at, &action): (usize, &usize)| {
            let percept = Percept::from_bits((0..8).map(|bit| at >> bit & 1 == 1));
            let percept = percept.unwrap();
            PolicyStep {
                place: Place::Percept(percept),
                percept,
                action: Action::new(action).unwrap(),
            }
        };
        actions.iter().enumerate().map(step).collect()
    }

    fn imprinting(theta_x: f64) -> Imprinting {
        let params = Params {
            theta_x,
            ..Params::default()
        };
        Imprinting::new(&params, Stream::new(1, StreamName::Imprinting))
    }

    #[test]
    fn algorithm_3_keeps_the_different_policies_of_the_shortest_length() {
        let mut imprinting = imprinting(0.5);
        let lengths = |i: &Imprinting| i.policies.iter().map(Vec::len).collect::<Vec<_>>();
        imprinting.after(true, &policy(&[0, 1, 2]));
        imprinting.after(true, &policy(&[0, 1, 3]));
        imprinting.after(true, &policy(&[0, 1, 2]));
        assert_eq!(
            lengths(&imprinting),
            [3, 3],
            "the same policy is added once"
        );
        imprinting.after(true, &policy(&[0, 0, 0, 0]));
        assert_eq!(lengths(&imprinting), [3, 3], "a longer policy is ignored");
        imprinting.after(true, &policy(&[2, 1]));
        assert_eq!(
            lengths(&imprinting),
            [2],
            "a shorter policy replaces the set"
        );
    }

    #[test]
    fn the_set_is_bounded_where_many_paths_are_shortest() {
        let mut imprinting = imprinting(0.5);
        for number in 0..3 * MOST_POLICIES {
            let actions: Vec<usize> = (0..12).map(|bit| number >> bit & 1).collect();
            imprinting.after(true, &policy(&actions));
        }
        assert_eq!(imprinting.policies.len(), MOST_POLICIES);
        imprinting.after(true, &policy(&[1]));
        assert_eq!(
            imprinting.policies.len(),
            1,
            "a shorter policy replaces the set"
        );
    }

    #[test]
    fn algorithm_2_replays_after_failures_only_with_probability_one_minus_theta_x() {
        let share = |theta_x| {
            let mut imprinting = imprinting(theta_x);
            assert!(
                imprinting.after(false, &policy(&[1])).is_none(),
                "[PS] is empty"
            );
            assert!(
                imprinting.after(true, &policy(&[0, 1])).is_none(),
                "a success"
            );
            let replays = (0..1000).filter(|_| imprinting.after(false, &policy(&[1])).is_some());
            replays.count()
        };
        assert_eq!((share(0.0), share(1.0)), (1000, 0));
        assert!((650..750).contains(&share(0.3)), "{}", share(0.3));
    }

    #[test]
    fn it_never_replays_when_switched_off() {
        let params = Params {
            imprinting: false,
            theta_x: 0.0,
            ..Params::default()
        };
        let mut imprinting = Imprinting::new(&params, Stream::new(1, StreamName::Imprinting));
        imprinting.after(true, &policy(&[0, 1]));
        assert!(imprinting.after(false, &policy(&[1])).is_none());
    }

    #[test]
    fn algorithm_4_updates_every_pair_of_the_policy_with_its_share() {
        let policy = policy(&[0, 1, 0]);
        let params = xcs::Params {
            dont_care: 0.0,
            ..xcs::Params::default()
        };
        let mut xcs = Xcs::new(params, 2, Stream::new(1, StreamName::Evolution));
        for step in &policy {
            xcs.form_match_set(&step.percept, &mut xcs::MatchSet::default());
        }
        let shares = Shares::new(1000.0, 3, 3, &Params::default());
        clone_behaviour(&mut xcs, &replayed_steps(&policy, &shares), 0.2);
        let values = policy.iter();
        let values = values.map(|step| xcs.values(&step.percept).get(step.action));
        assert_eq!(
            values.collect::<Vec<_>>(),
            [Some(810.0), Some(900.0), Some(1000.0)]
        );
        let percept = policy[0].percept;
        assert_eq!(xcs.values(&percept).get(Action::new(1).unwrap()), Some(0.0));
    }
}
