//! Experts that co-evolve with the learner: the future work of the paper (end of section III-B).
//!
//! The paper stores its best policies in a list, draws one at random after a failure and replays it
//! unchanged (Alg. 2 to 4). Here two separate XCS do this. The *policy selector* chooses the
//! policy: it perceives where the failure ended, and is rewarded if the next episode reaches the
//! goal. The *behaviour cloner* learns the values of the steps of the best policies. Its rules
//! generalise, so it also advises on the path on which the robot failed.

use crate::agent::credit::imprinting::{Imprinting, ReplayedStep};
use crate::agent::credit::policy::Policy;
use xcs::random::Stream;
use xcs::{self, Action, MatchSet, Percept, PredictionArray, Xcs};

/// The maximum number of policies among which the policy selector chooses.
const MOST_POLICIES: usize = 4;
/// The probability that the policy selector tries a random policy instead of the best-rated one.
const EXPLORE: f64 = 0.5;

/// The policy selector and the behaviour cloner.
#[derive(Debug, Clone)]
pub(super) struct Experts {
    policy_selector: Xcs,
    behaviour_cloner: Xcs,
    /// The reward of the policy selector for a success.
    goal: f64,
    choices: Choices,
}

/// The learned state of the experts besides their rules.
#[derive(Debug, Clone)]
struct Choices {
    stream: Stream,
    /// The percept and policy of the policy selector's last choice, until it is rewarded.
    chosen: Option<(Percept, Action)>,
    /// The least share of the reward that any step of the best policies received.
    least_share: f64,
}

impl Experts {
    /// Creates experts for a robot with `actions` actions. The streams are for choices, policy
    /// selector and behaviour cloner.
    pub fn new(xcs: &xcs::Params, actions: usize, goal: f64, streams: [Stream; 3]) -> Self {
        let [stream, policy_selector, behaviour_cloner] = streams;
        Self {
            policy_selector: Xcs::new(xcs.clone(), MOST_POLICIES, policy_selector),
            behaviour_cloner: Xcs::new(xcs.clone(), actions, behaviour_cloner),
            goal,
            choices: Choices {
                stream,
                chosen: None,
                least_share: f64::INFINITY,
            },
        }
    }

    /// Returns the steps to replay after an episode, if any, in place of the draw of Alg. 2: the
    /// policy chosen by the policy selector, and the behaviour cloner's advice for the failed path.
    /// `succeeded` assigns shares to the steps of a policy, as if it had just succeeded.
    pub fn after(
        &mut self,
        reached_goal: bool,
        policy: &Policy,
        imprinting: &mut Imprinting,
        succeeded: impl Fn(&Policy) -> Vec<ReplayedStep>,
    ) -> Option<Vec<ReplayedStep>> {
        self.judge(reached_goal);
        if reached_goal {
            imprinting.store(policy);
            if imprinting.contains(policy) {
                self.study(&succeeded(policy));
            }
            return None;
        }
        let failed_at = policy.last()?.percept;
        let mut replayed_steps = succeeded(self.choose(imprinting.replayable()?, &failed_at));
        let advice = self.advise(policy.iter().map(|step| step.percept));
        let is_new = |one: &ReplayedStep| {
            replayed_steps
                .iter()
                .all(|known| known.percept != one.percept)
        };
        let advice: Vec<ReplayedStep> = advice.into_iter().filter(is_new).collect();
        replayed_steps.extend(advice);
        Some(replayed_steps)
    }

    /// Rewards the policy selector for its choice before this episode.
    fn judge(&mut self, reached_goal: bool) {
        let Some((percept, action)) = self.choices.chosen.take() else {
            return;
        };
        let set = self.policy_selector.matching_action_set(&percept, action);
        let payoff = if reached_goal { self.goal } else { 0.0 };
        self.policy_selector
            .update(&set, payoff, self.policy_selector.params().beta);
        self.policy_selector.evolve(&set);
    }

    /// Trains the behaviour cloner on one of the best policies: the target of each step is its
    /// share, the target of any other action there is 0.
    fn study(&mut self, policy: &[ReplayedStep]) {
        let mut match_set = MatchSet::default();
        for step in policy {
            self.choices.least_share = self.choices.least_share.min(step.share);
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

    /// Chooses the policy to replay after a failure that ended in `percept`. `policies` must not be
    /// empty.
    fn choose<'a>(&mut self, policies: &'a [Policy], percept: &Percept) -> &'a Policy {
        let mut match_set = MatchSet::default();
        self.policy_selector.form_match_set(percept, &mut match_set);
        let values = self.policy_selector.predict(&match_set);
        let among = &policies[..policies.len().min(MOST_POLICIES)];
        let explores = self.choices.stream.chance(EXPLORE);
        let drawn = self.choices.stream.below(among.len());
        let at = if explores {
            drawn
        } else {
            best(&values, among.len())
        };
        self.choices.chosen = Action::new(at).map(|action| (*percept, action));
        &among[at]
    }

    /// Returns the behaviour cloner's actions along a path where it is certain: exactly one action
    /// is best, and its value is at least half the least share of a step of the best policies.
    fn advise(&self, path: impl IntoIterator<Item = Percept>) -> Vec<ReplayedStep> {
        let mut advice: Vec<ReplayedStep> = Vec::new();
        for percept in path {
            let values = self.behaviour_cloner.values(&percept);
            let mut best = values.best_actions();
            let (action, share) = (best.next(), values.greatest().unwrap_or(0.0));
            let is_sure = best.next().is_none() && share >= 0.5 * self.choices.least_share;
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
}

/// Returns the index of the first best-rated policy among the first `count`.
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
    use crate::agent::credit::policy::{Place, PolicyStep};
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
            StreamName::PolicySelector,
            StreamName::BehaviourCloner,
        ];
        Experts::new(&params, 4, 1000.0, streams.map(|name| Stream::new(1, name)))
    }

    #[test]
    fn the_policy_selector_learns_which_policy_helps_after_which_failure() {
        let mut experts = experts();
        let step = |it| PolicyStep {
            place: Place::Percept(percept("0000")),
            percept: percept("0000"),
            action: action(it),
        };
        let policies = [0, 1].map(|it| vec![step(it)]);
        let helps = |failed: &str| usize::from(failed == "1100");
        for turn in 0..400 {
            let failed = ["1100", "0011"][turn % 2];
            let chosen = experts.choose(&policies, &percept(failed))[0]
                .action
                .index();
            experts.judge(chosen == helps(failed));
        }
        for failed in ["1100", "0011"] {
            let values = experts.policy_selector.values(&percept(failed));
            assert_eq!(best(&values, 2), helps(failed), "{failed}: {values:?}");
        }
    }

    #[test]
    fn the_behaviour_cloner_advises_the_best_policy_and_gives_no_advice_without_one() {
        let mut experts = experts();
        let path = [percept("0001"), percept("1000")];
        assert_eq!(experts.advise(path), []);
        let policy = [0, 1].map(|at| ReplayedStep {
            percept: path[at],
            action: action(at + 1),
            share: [900.0, 1000.0][at],
        });
        (0..200).for_each(|_| experts.study(&policy));
        let advice = experts.advise(path.into_iter().chain(path));
        let actions: Vec<_> = advice.iter().map(|step| step.action.index()).collect();
        assert_eq!(actions, [1, 2], "{advice:?}");
    }
}
