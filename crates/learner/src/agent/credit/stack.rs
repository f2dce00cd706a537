//! The reward stack \[R\], and the sharing of a long-term reward along it.

use crate::agent::credit::params::{Params, Sharing, StackEvolution};
use crate::agent::credit::policy::{Place, Policy, PolicyStep};
use xcs::{ActionSet, Xcs};

/// \[R\]: the action sets of an episode with their places, oldest first.
#[derive(Debug, Clone, Default)]
pub(super) struct RewardStack {
    sets: Vec<ActionSet>,
    places: Vec<Place>,
}

impl RewardStack {
    /// Adds the latest action set and the place where it was formed. With [`StackEvolution::EachStep`], the GA may run
    /// in it now.
    pub fn push(&mut self, xcs: &mut Xcs, set: ActionSet, place: Place, evolution: StackEvolution) {
        if evolution == StackEvolution::EachStep {
            xcs.evolve(&set);
        }
        self.sets.push(set);
        self.places.push(place);
    }

    /// Returns the number of steps so far.
    pub fn len(&self) -> usize {
        self.sets.len()
    }

    /// Returns the executed policy.
    pub fn policy(&self) -> Policy {
        let steps = self.sets.iter().zip(&self.places);
        steps
            .map(|(set, &place)| PolicyStep {
                place,
                percept: set.percept,
                action: set.action,
            })
            .collect()
    }

    /// Empties the stack and updates each set with its share of the reward, latest first, at
    /// learning rate `beta`. With [`StackEvolution::AfterCredit`], the GA may then run in the set.
    pub fn unwind(&mut self, xcs: &mut Xcs, shares: &Shares, beta: f64, evolution: StackEvolution) {
        self.places.clear();
        for (set, share) in self.sets.drain(..).rev().zip(shares.backward()) {
            xcs.update(&set, share, beta);
            if evolution == StackEvolution::AfterCredit {
                xcs.evolve(&set);
            }
        }
    }
}

/// The share of the long-term reward for each step of an episode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shares {
    reward: f64,
    gamma: f64,
}

impl Shares {
    /// Shares the reward r_l among `steps` steps. `shortest` is the length of the shortest success
    /// so far in the trial. A failure that is shorter also gets full shares.
    pub fn new(reward: f64, steps: usize, shortest: usize, params: &Params) -> Self {
        match params.sharing {
            Sharing::Even => {
                let given = params.even_constant > 0.0;
                let c = if given {
                    params.even_constant
                } else {
                    shortest.min(steps) as f64
                };
                Self {
                    reward: c * reward / steps.max(1) as f64,
                    gamma: 1.0,
                }
            }
            Sharing::Discounted => Self {
                reward,
                gamma: params.gamma,
            },
        }
    }

    /// Returns r_a of the last step, of the step before it, and so on (Eq. 8 and 9).
    pub fn backward(&self) -> impl Iterator<Item = f64> {
        let gamma = self.gamma;
        std::iter::successors(Some(self.reward), move |share| Some(share * gamma))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcs::random::Stream;
    use xcs::{Action, MatchSet};
    use xcscr_robot::streams::StreamName;

    fn sharing(sharing: Sharing) -> Params {
        Params {
            sharing,
            ..Params::default()
        }
    }

    /// Returns the number of micro-classifiers after five steps in one percept, and after their credit.
    fn micro_classifiers(evolution: StackEvolution) -> [u32; 2] {
        let params = xcs::Params {
            theta_ga: 1,
            ..xcs::Params::default()
        };
        let mut xcs = Xcs::new(params, 2, Stream::new(1, StreamName::Evolution));
        let (mut stack, mut set) = (RewardStack::default(), MatchSet::default());
        for _ in 0..5 {
            xcs.form_match_set(&"0101".parse().unwrap(), &mut set);
            let set = set.action_set(Action::new(0).unwrap()).unwrap();
            let place = Place::Percept(set.percept);
            stack.push(&mut xcs, set, place, evolution);
        }
        let formed = xcs.population().micro();
        let shares = Shares::new(1000.0, 5, 5, &Params::default());
        // The GA would be due again.
        (0..9).for_each(|_| xcs.form_match_set(&"0101".parse().unwrap(), &mut set));
        stack.unwind(&mut xcs, &shares, 0.2, evolution);
        [formed, xcs.population().micro()]
    }

    #[test]
    fn the_ga_runs_when_a_set_is_formed_or_after_its_credit_but_not_in_both() {
        let [formed, credited] = micro_classifiers(StackEvolution::EachStep);
        assert!(formed > 2 && credited == formed, "{formed}, {credited}");
        let [formed, credited] = micro_classifiers(StackEvolution::AfterCredit);
        assert!(formed == 2 && credited > formed, "{formed}, {credited}");
    }

    #[test]
    fn equation_8_gives_every_step_the_same() {
        let params = Params {
            even_constant: 5.0,
            ..sharing(Sharing::Even)
        };
        let shares = Shares::new(1000.0, 20, 10, &params);
        assert!(shares.backward().take(20).all(|share| share == 250.0));
    }

    #[test]
    fn equation_8_gives_the_shortest_success_full_shares_by_default() {
        let even = sharing(Sharing::Even);
        let shares = Shares::new(1000.0, 10, 10, &even);
        assert_eq!(shares.backward().nth(3), Some(1000.0));
        let longer = Shares::new(1000.0, 20, 10, &even);
        assert_eq!(longer.backward().nth(3), Some(500.0));
    }

    #[test]
    fn equation_9_counts_back_from_the_goal() {
        let shares = Shares::new(1000.0, 20, 10, &sharing(Sharing::Discounted));
        let first: Vec<f64> = shares.backward().take(3).collect();
        assert_eq!(first, [1000.0, 900.0, 810.0]);
    }
}
