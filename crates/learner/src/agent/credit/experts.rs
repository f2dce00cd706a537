//! Experts that co-evolve with the learner: the future work of the paper (end of section III-B).
//!
//! The paper keeps its best policies in a list, draws one at random after a failure, and rehearses
//! it word for word (Alg. 2 to 4). Here two XCS of their own do that. The *keeper* chooses the
//! policy: it perceives where the failure ended, and is paid by whether the next episode reaches the
//! goal. The *cloner* learns from the best policies what their steps are worth, and its rules
//! generalise: it also advises on the way on which the robot failed.

use serde::{Deserialize, Serialize};

use crate::agent::credit::imprinting::{Imprinting, Policy, ReplayedStep};
use xcs::random::Stream;
use xcs::{self, Action, Learned, MatchSet, Percept, PredictionArray, Xcs};

/// The most policies between which the keeper chooses.
const MOST_POLICIES: usize = 4;
/// The chance that the keeper tries any policy instead of the one that it rates best.
const EXPLORE: f64 = 0.5;

/// Keeper and cloner.
#[derive(Debug, Clone)]
pub(super) struct Experts {
    policy_selector: Xcs,
    behaviour_cloner: Xcs,
    /// What the keeper is paid for a success.
    goal: f64,
    kept: Kept,
}

/// What learning changes in them beside their rules.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Kept {
    stream: Stream,
    /// What the keeper chose after the failure before, and where.
    chosen: Option<(Percept, Action)>,
    /// The least share of the reward that a step of the best policies got.
    least_share: f64,
}

/// All that they keep from one episode to the next: of keeper, cloner, and beside their rules.
pub(super) type Remembered = (Learned, Learned, Kept);

impl Experts {
    /// For a robot with `actions` actions; the streams are for choices, keeper and cloner.
    pub fn new(xcs: &xcs::Params, actions: usize, goal: f64, streams: [Stream; 3]) -> Self {
        let [stream, policy_selector, behaviour_cloner] = streams;
        Self {
            policy_selector: Xcs::new(xcs.clone(), MOST_POLICIES, policy_selector),
            behaviour_cloner: Xcs::new(xcs.clone(), actions, behaviour_cloner),
            goal,
            kept: Kept {
                stream,
                chosen: None,
                least_share: f64::INFINITY,
            },
        }
    }

    /// What is rehearsed after an episode, if anything is, in place of what Alg. 2 would draw: the
    /// policy that the keeper chooses, and what the cloner advises for the way of the failure.
    /// `succeeded` makes examples of a policy, as if it had just succeeded.
    pub fn after(
        &mut self,
        reached_goal: bool,
        policy: &Policy,
        imprinting: &mut Imprinting,
        succeeded: impl Fn(&Policy) -> Vec<ReplayedStep>,
    ) -> Option<Vec<ReplayedStep>> {
        self.judge(reached_goal);
        if reached_goal {
            imprinting.keep(policy);
            if imprinting.keeps(policy) {
                self.study(&succeeded(policy));
            }
            return None;
        }
        let (failed_at, _) = policy.last()?;
        let mut replayed_steps = succeeded(self.choose(imprinting.rehearsable()?, failed_at));
        let advice = self.advise(policy.iter().map(|(percept, _)| *percept));
        let is_new = |one: &ReplayedStep| {
            replayed_steps
                .iter()
                .all(|known| known.percept != one.percept)
        };
        let advice: Vec<ReplayedStep> = advice.into_iter().filter(is_new).collect();
        replayed_steps.extend(advice);
        Some(replayed_steps)
    }

    /// Pays the keeper for what it chose before this episode.
    fn judge(&mut self, reached_goal: bool) {
        let Some((percept, action)) = self.kept.chosen.take() else {
            return;
        };
        let set = self.policy_selector.matching_action_set(&percept, action);
        let payoff = if reached_goal { self.goal } else { 0.0 };
        self.policy_selector
            .update(&set, payoff, self.policy_selector.params().beta);
        self.policy_selector.evolve(&set);
    }

    /// Teaches the cloner one of the best policies: each step is worth its share, any other action
    /// there nothing.
    fn study(&mut self, policy: &[ReplayedStep]) {
        let mut match_set = MatchSet::default();
        for step in policy {
            self.kept.least_share = self.kept.least_share.min(step.share);
            self.behaviour_cloner
                .form_match_set(&step.percept, &mut match_set);
            for action in Action::all(self.behaviour_cloner.actions()) {
                let share = if action == step.action {
                    step.share
                } else {
                    0.0
                };
                let set = self
                    .behaviour_cloner
                    .matching_action_set(&step.percept, action);
                self.behaviour_cloner
                    .update(&set, share, self.behaviour_cloner.params().beta);
                self.behaviour_cloner.evolve(&set);
            }
        }
    }

    /// The policy to be rehearsed after a failure that ended in `percept`; there must be one.
    fn choose<'a>(&mut self, policies: &'a [Policy], percept: &Percept) -> &'a Policy {
        let mut match_set = MatchSet::default();
        self.policy_selector.form_match_set(percept, &mut match_set);
        let values = self.policy_selector.predict(&match_set);
        let among = &policies[..policies.len().min(MOST_POLICIES)];
        let explores = self.kept.stream.chance(EXPLORE);
        let drawn = self.kept.stream.below(among.len());
        let at = if explores {
            drawn
        } else {
            best(&values, among.len())
        };
        self.kept.chosen = Action::new(at).map(|action| (*percept, action));
        &among[at]
    }

    /// What the cloner would have done on the way, where it is sure: where one action alone is
    /// worth at least half of what the least step of the best policies is.
    fn advise(&self, way: impl IntoIterator<Item = Percept>) -> Vec<ReplayedStep> {
        let mut advice: Vec<ReplayedStep> = Vec::new();
        for percept in way {
            let values = self.behaviour_cloner.values(&percept);
            let mut best = values.best_actions();
            let (action, share) = (best.next(), values.greatest().unwrap_or(0.0));
            let is_sure = best.next().is_none() && share >= 0.5 * self.kept.least_share;
            let is_new = advice.iter().all(|step| step.percept != percept);
            advice.extend(
                action
                    .filter(|_| is_sure && is_new)
                    .map(|action| ReplayedStep {
                        percept,
                        action,
                        share,
                    }),
            );
        }
        advice
    }

    /// What learning has changed so far.
    pub fn kept(&self) -> Remembered {
        let (policy_selector, behaviour_cloner) = (
            self.policy_selector.learned(),
            self.behaviour_cloner.learned(),
        );
        (policy_selector, behaviour_cloner, self.kept.clone())
    }

    /// Goes on from what was kept; `false` if it is damaged.
    fn resume(&mut self, (policy_selector, behaviour_cloner, kept): Remembered) -> bool {
        let sound = kept
            .chosen
            .is_none_or(|(_, action)| action.index() < MOST_POLICIES)
            && kept.least_share >= 0.0;
        self.kept = kept;
        sound
            && self.policy_selector.resume(policy_selector)
            && self.behaviour_cloner.resume(behaviour_cloner)
    }
}

/// The experts, if there are any, go on from what was kept; `false` if it is damaged or not theirs.
pub(super) fn resume(experts: &mut Option<Experts>, kept: Option<Remembered>) -> bool {
    match (experts, kept) {
        (Some(experts), Some(kept)) => experts.resume(kept),
        (experts, kept) => experts.is_none() && kept.is_none(),
    }
}

/// The first of the best-rated of `count` policies.
fn best(values: &PredictionArray, count: usize) -> usize {
    let rated = |at: usize| values.as_slice()[at].unwrap_or(f64::NEG_INFINITY);
    (1..count).fold(
        0,
        |best, at| if rated(at) > rated(best) { at } else { best },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcscr_robot::streams::StreamName;

    fn percept(text: &str) -> Percept {
        text.parse().unwrap()
    }

    fn action(index: usize) -> Action {
        Action::new(index).unwrap()
    }

    fn experts() -> Experts {
        let params = xcs::Params {
            dont_care: 0.5,
            ..xcs::Params::default()
        };
        let streams = [
            StreamName::Experts,
            StreamName::Keeper,
            StreamName::BehaviourCloner,
        ];
        Experts::new(&params, 4, 1000.0, streams.map(|name| Stream::new(1, name)))
    }

    #[test]
    fn the_keeper_learns_after_which_failure_which_policy_helps() {
        let mut experts = experts();
        let policies = [0, 1].map(|it| vec![(percept("0000"), action(it))]);
        let helps = |failed: &str| usize::from(failed == "1100");
        for turn in 0..400 {
            let failed = ["1100", "0011"][turn % 2];
            let chosen = experts.choose(&policies, &percept(failed))[0].1.index();
            experts.judge(chosen == helps(failed));
        }
        for failed in ["1100", "0011"] {
            let values = experts.policy_selector.values(&percept(failed));
            assert_eq!(best(&values, 2), helps(failed), "{failed}: {values:?}");
        }
    }

    #[test]
    fn the_cloner_advises_what_the_best_policy_does_and_is_silent_before_it_knows_one() {
        let mut experts = experts();
        let way = [percept("0001"), percept("1000")];
        assert_eq!(experts.advise(way), []);
        let policy = [0, 1].map(|at| ReplayedStep {
            percept: way[at],
            action: action(at + 1),
            share: [900.0, 1000.0][at],
        });
        (0..200).for_each(|_| experts.study(&policy));
        let advice = experts.advise(way.into_iter().chain(way));
        let actions: Vec<_> = advice.iter().map(|step| step.action.index()).collect();
        assert_eq!(actions, [1, 2], "{advice:?}");
    }
}
