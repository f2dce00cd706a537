//! Experts that co-evolve with the learner: the future work of the paper (end of section III-B).
//!
//! The paper keeps its best policies in a list, draws one at random after a failure, and rehearses
//! it word for word (Alg. 2 to 4). Here two XCS of their own do that. The *keeper* chooses the
//! policy: it perceives where the failure ended, and is paid by whether the next episode reaches the
//! goal. The *cloner* learns from the best policies what their steps are worth, and its rules
//! generalise: it also advises on the way on which the robot failed.

use serde::{Deserialize, Serialize};

use crate::agent::credit::imprinting::{Imprinting, Lesson, Policy};
use xcs::random::Stream;
use xcs::{self, Action, Learned, MatchSet, Percept, PredictionArray, Xcs};

/// The most policies between which the keeper chooses.
const MOST_POLICIES: usize = 4;
/// The chance that the keeper tries any policy instead of the one that it rates best.
const EXPLORE: f64 = 0.5;

/// Keeper and cloner.
#[derive(Debug, Clone)]
pub(super) struct Experts {
    keeper: Xcs,
    cloner: Xcs,
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
        let [stream, keeper, cloner] = streams;
        Self {
            keeper: Xcs::new(xcs.clone(), MOST_POLICIES, keeper),
            cloner: Xcs::new(xcs.clone(), actions, cloner),
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
    /// `succeeded` makes lessons of a policy, as if it had just succeeded.
    pub fn after(
        &mut self,
        reached_goal: bool,
        policy: &Policy,
        imprinting: &mut Imprinting,
        succeeded: impl Fn(&Policy) -> Vec<Lesson>,
    ) -> Option<Vec<Lesson>> {
        self.judge(reached_goal);
        if reached_goal {
            imprinting.keep(policy);
            if imprinting.keeps(policy) {
                self.study(&succeeded(policy));
            }
            return None;
        }
        let (failed_at, _) = policy.last()?;
        let mut lessons = succeeded(self.choose(imprinting.rehearsable()?, failed_at));
        let advice = self.advise(policy.iter().map(|(percept, _)| *percept));
        let is_new = |one: &Lesson| lessons.iter().all(|known| known.percept != one.percept);
        let advice: Vec<Lesson> = advice.into_iter().filter(is_new).collect();
        lessons.extend(advice);
        Some(lessons)
    }

    /// Pays the keeper for what it chose before this episode.
    fn judge(&mut self, reached_goal: bool) {
        let Some((percept, action)) = self.kept.chosen.take() else {
            return;
        };
        let set = self.keeper.matching_action_set(&percept, action);
        let payoff = if reached_goal { self.goal } else { 0.0 };
        self.keeper.update(&set, payoff, self.keeper.params().beta);
        self.keeper.evolve(&set);
    }

    /// Teaches the cloner one of the best policies: each step is worth its share, any other action
    /// there nothing.
    fn study(&mut self, policy: &[Lesson]) {
        let mut match_set = MatchSet::default();
        for lesson in policy {
            self.kept.least_share = self.kept.least_share.min(lesson.share);
            self.cloner.form_match_set(&lesson.percept, &mut match_set);
            for action in Action::all(self.cloner.actions()) {
                let share = if action == lesson.action {
                    lesson.share
                } else {
                    0.0
                };
                let set = self.cloner.matching_action_set(&lesson.percept, action);
                self.cloner.update(&set, share, self.cloner.params().beta);
                self.cloner.evolve(&set);
            }
        }
    }

    /// The policy to be rehearsed after a failure that ended in `percept`; there must be one.
    fn choose<'a>(&mut self, policies: &'a [Policy], percept: &Percept) -> &'a Policy {
        let mut match_set = MatchSet::default();
        self.keeper.form_match_set(percept, &mut match_set);
        let worth = self.keeper.predict(&match_set);
        let among = &policies[..policies.len().min(MOST_POLICIES)];
        let explores = self.kept.stream.chance(EXPLORE);
        let drawn = self.kept.stream.below(among.len());
        let at = if explores {
            drawn
        } else {
            best(&worth, among.len())
        };
        self.kept.chosen = Action::new(at).map(|action| (*percept, action));
        &among[at]
    }

    /// What the cloner would have done on the way, where it is sure: where one action alone is
    /// worth at least half of what the least step of the best policies is.
    fn advise(&self, way: impl IntoIterator<Item = Percept>) -> Vec<Lesson> {
        let mut advice: Vec<Lesson> = Vec::new();
        for percept in way {
            let worth = self.cloner.worth(&percept);
            let mut best = worth.best_actions();
            let (action, share) = (best.next(), worth.greatest().unwrap_or(0.0));
            let is_sure = best.next().is_none() && share >= 0.5 * self.kept.least_share;
            let is_new = advice.iter().all(|lesson| lesson.percept != percept);
            advice.extend(action.filter(|_| is_sure && is_new).map(|action| Lesson {
                percept,
                action,
                share,
            }));
        }
        advice
    }

    /// What learning has changed so far.
    pub fn kept(&self) -> Remembered {
        let (keeper, cloner) = (self.keeper.learned(), self.cloner.learned());
        (keeper, cloner, self.kept.clone())
    }

    /// Goes on from what was kept; `false` if it is damaged.
    fn resume(&mut self, (keeper, cloner, kept): Remembered) -> bool {
        let sound = kept
            .chosen
            .is_none_or(|(_, action)| action.index() < MOST_POLICIES)
            && kept.least_share >= 0.0;
        self.kept = kept;
        sound && self.keeper.resume(keeper) && self.cloner.resume(cloner)
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
fn best(worth: &PredictionArray, count: usize) -> usize {
    let rated = |at: usize| worth.as_slice()[at].unwrap_or(f64::NEG_INFINITY);
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
        let streams = [StreamName::Experts, StreamName::Keeper, StreamName::Cloner];
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
            let worth = experts.keeper.worth(&percept(failed));
            assert_eq!(best(&worth, 2), helps(failed), "{failed}: {worth:?}");
        }
    }

    #[test]
    fn the_cloner_advises_what_the_best_policy_does_and_is_silent_before_it_knows_one() {
        let mut experts = experts();
        let way = [percept("0001"), percept("1000")];
        assert_eq!(experts.advise(way), []);
        let policy = [0, 1].map(|at| Lesson {
            percept: way[at],
            action: action(at + 1),
            share: [900.0, 1000.0][at],
        });
        (0..200).for_each(|_| experts.study(&policy));
        let advice = experts.advise(way.into_iter().chain(way));
        let actions: Vec<_> = advice.iter().map(|lesson| lesson.action.index()).collect();
        assert_eq!(actions, [1, 2], "{advice:?}");
    }
}
