//! Chooses the episodes of a highlights recording.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use foxglove::Decode;
use foxglove::messages::{Point3, SceneUpdate};
use serde::Deserialize;

use crate::record::error::RecordError;
use crate::record::read::reader::{Message, Recording};
use crate::record::topics::Topic;
use crate::record::topics::policy::DART_CORNERS;

/// How many episodes are shown because the policy changed most in them.
const MOST_CHANGES: usize = 3;

/// Why an episode is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reason {
    First,
    FirstGoal,
    GreatChange,
    FirstOptimal,
}

/// An episode of a highlights recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Segment {
    /// The episode's number, from 1.
    pub episode: u32,
    reasons: Vec<Reason>,
    /// Arrows of the policy that it changed.
    pub changed: usize,
}

impl Segment {
    /// What is seen. That a policy is optimal is said once it is: it becomes so at the episode's end.
    pub fn title(&self, is_over: bool) -> String {
        let is_alone = self.reasons.len() == 1;
        let reasons = self.reasons.iter().filter_map(|reason| match reason {
            Reason::First => Some("how it begins"),
            Reason::FirstGoal => Some("the goal for the first time"),
            Reason::GreatChange => Some("a great change of policy"),
            Reason::FirstOptimal if is_over => Some("the first optimal policy"),
            Reason::FirstOptimal => is_alone.then_some("the last episode before the optimum"),
        });
        let reasons: Vec<&str> = reasons.collect();
        format!("Episode {}: {}", self.episode, reasons.join(", "))
    }

    /// For how long it may be shown, in nanoseconds.
    pub fn most_ns(&self) -> u64 {
        const SECOND_NS: u64 = 1_000_000_000;
        match self.reasons[0] {
            Reason::First | Reason::FirstGoal => 16 * SECOND_NS,
            Reason::GreatChange | Reason::FirstOptimal => 12 * SECOND_NS,
        }
    }
}

/// What an episode came to.
struct Ended {
    episode: u32,
    goal: bool,
    optimal: bool,
    changed: usize,
}

/// The fields of `/episode` that count here.
#[derive(Deserialize)]
struct Figures {
    episode: u32,
    outcome: String,
    optimal: bool,
}

/// The turning points of a run by its `run.mcap`, in their order.
///
/// # Errors
/// When the recording is damaged.
pub fn segments(run: &Recording) -> Result<Vec<Segment>, RecordError> {
    let mut ended = Vec::new();
    let mut policy = Policy::default();
    for message in run.messages() {
        let message = message?;
        match Topic::named(message.topic()) {
            Some(Topic::Policy) => policy.see(run, &message)?,
            Some(Topic::Episode) => {
                let figures: Figures = serde_json::from_slice(&message.data)
                    .map_err(|fault| run.damaged(fault.to_string()))?;
                if figures.outcome != "running" {
                    ended.push(Ended {
                        episode: figures.episode,
                        goal: figures.outcome == "goal",
                        optimal: figures.optimal,
                        // A policy that stays as it is is not shown again.
                        changed: std::mem::take(&mut policy.changed),
                    });
                }
            }
            _ => {}
        }
    }
    Ok(chosen(&ended))
}

/// The arrows that were drawn last, and how many of them are new.
#[derive(Default)]
struct Policy {
    arrows: BTreeSet<[u64; 4]>,
    changed: usize,
}

impl Policy {
    fn see(&mut self, run: &Recording, message: &Message) -> Result<(), RecordError> {
        let scene = SceneUpdate::decode(message.data.as_slice())
            .map_err(|fault| run.damaged(fault.to_string()))?;
        let painted = scene.entities.iter().flat_map(|entity| &entity.triangles);
        let arrows = painted.flat_map(|list| list.points.chunks_exact(DART_CORNERS));
        let arrows: BTreeSet<_> = arrows.map(corner_bits).collect();
        let only_in = |a: &BTreeSet<_>, b| a.difference(b).count();
        self.changed = only_in(&arrows, &self.arrows).max(only_in(&self.arrows, &arrows));
        self.arrows = arrows;
        Ok(())
    }
}

/// Where an arrow is, and where it points: its tip and its left corner.
fn corner_bits(dart: &[Point3]) -> [u64; 4] {
    let (tip, left) = (dart[0], dart[1]);
    [tip.x, tip.y, left.x, left.y].map(f64::to_bits)
}

fn chosen(ended: &[Ended]) -> Vec<Segment> {
    let mut reasons: BTreeMap<u32, Vec<Reason>> = BTreeMap::new();
    let mut add = |ended: Option<&Ended>, reason| {
        if let Some(ended) = ended {
            reasons.entry(ended.episode).or_default().push(reason);
        }
    };
    add(ended.first(), Reason::First);
    add(ended.iter().find(|one| one.goal), Reason::FirstGoal);
    add(ended.iter().find(|one| one.optimal), Reason::FirstOptimal);
    let mut changes: Vec<&Ended> = ended.iter().filter(|one| one.changed > 0).collect();
    changes.retain(|one| !reasons.contains_key(&one.episode));
    changes.sort_by_key(|one| (Reverse(one.changed), one.episode));
    for one in changes.into_iter().take(MOST_CHANGES) {
        reasons.insert(one.episode, vec![Reason::GreatChange]);
    }
    let segment = |one: &Ended| {
        Some(Segment {
            episode: one.episode,
            reasons: reasons.remove(&one.episode)?,
            changed: one.changed,
        })
    };
    ended.iter().filter_map(segment).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Titles of the segments of episodes with these goals, optima and changes.
    fn titles(episodes: &[(bool, bool, usize)]) -> Vec<String> {
        let numbered = (1..).zip(episodes);
        let ended: Vec<Ended> = numbered
            .map(|(episode, &(goal, optimal, changed))| Ended {
                episode,
                goal,
                optimal,
                changed,
            })
            .collect();
        let segments = chosen(&ended);
        segments.iter().map(|segment| segment.title(true)).collect()
    }

    #[test]
    fn the_turning_points_come_in_the_order_of_time_and_each_episode_once() {
        let run = [
            (false, false, 9),
            (false, false, 3),
            (true, false, 8),
            (true, false, 4),
            (true, false, 1),
            (true, false, 5),
            (true, true, 2),
            (true, false, 7),
        ];
        let wanted = [
            "Episode 1: how it begins",
            "Episode 3: the goal for the first time",
            "Episode 4: a great change of policy",
            "Episode 6: a great change of policy",
            "Episode 7: the first optimal policy",
            "Episode 8: a great change of policy",
        ];
        assert_eq!(titles(&run), wanted);
    }

    #[test]
    fn nothing_is_called_optimal_before_it_is() {
        let title = |reasons: &[Reason], is_over| {
            let segment = Segment {
                episode: 3,
                reasons: reasons.to_vec(),
                changed: 1,
            };
            segment.title(is_over)
        };
        let both = [Reason::FirstGoal, Reason::FirstOptimal];
        assert_eq!(
            title(&both, false),
            "Episode 3: the goal for the first time"
        );
        assert!(title(&both, true).ends_with(", the first optimal policy"));
        assert!(title(&both[1..], false).ends_with(": the last episode before the optimum"));
    }

    #[test]
    fn one_episode_can_be_all_of_it_and_nothing_is_claimed_that_never_was() {
        assert_eq!(
            titles(&[(true, true, 4)]),
            ["Episode 1: how it begins, the goal for the first time, the first optimal policy"]
        );
        assert_eq!(
            titles(&[(false, false, 0), (false, false, 0)]),
            ["Episode 1: how it begins"]
        );
    }
}
