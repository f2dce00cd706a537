//! Selects the most instructive episodes of a run.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use serde::Serialize;

use crate::Error;
use crate::record::event::{End, Learned};
use crate::record::reader::Recording;
use crate::record::topics::Topic;
use crate::world::Maze;

/// The number of episodes that are shown because they changed the policy most.
const MAX_CHANGES: usize = 3;

/// Why an episode is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reason {
    First,
    FirstGoal,
    GreatChange,
    FirstOptimal,
}

/// An instructive episode.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Chapter {
    /// The episode's number, from 1.
    pub episode: u32,
    /// Why it is instructive.
    pub title: String,
}

impl Reason {
    fn text(self) -> &'static str {
        match self {
            Self::First => "how it begins",
            Self::FirstGoal => "the goal for the first time",
            Self::GreatChange => "a great change of policy",
            Self::FirstOptimal => "the first optimal policy",
        }
    }
}

/// The result of an episode.
struct Ended {
    episode: u32,
    goal: bool,
    optimal: bool,
    changed: usize,
}

/// Returns the turning points of a run from its `run.mcap`, in order of time.
///
/// # Errors
/// If the recording is damaged.
pub fn chapters(run: &Recording, maze: &Maze) -> Result<Vec<Chapter>, Error> {
    let mut ended = Vec::new();
    let (mut learned, mut changed) = (Learned::default(), 0);
    for message in run.messages() {
        let message = message?;
        match Topic::named(message.topic()) {
            Some(Topic::Values) => {
                let now = Learned::of_message(&message.data, maze);
                let now = now.map_err(|fault| run.damaged(fault))?;
                changed = now.changes_from(&learned);
                learned = now;
            }
            Some(Topic::Episode) => {
                let end: End = run.fact(&message)?;
                ended.push(Ended {
                    episode: end.episode,
                    goal: end.outcome == "goal",
                    optimal: end.optimal,
                    // An unchanged policy is not written again, so the count is reset here.
                    changed: std::mem::take(&mut changed),
                });
            }
            _ => {}
        }
    }
    Ok(chosen(&ended))
}

fn chosen(ended: &[Ended]) -> Vec<Chapter> {
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
    for one in changes.into_iter().take(MAX_CHANGES) {
        reasons.insert(one.episode, vec![Reason::GreatChange]);
    }
    let chapter = |one: &Ended| {
        let reasons: Vec<&str> = reasons
            .remove(&one.episode)?
            .into_iter()
            .map(Reason::text)
            .collect();
        Some(Chapter {
            episode: one.episode,
            title: format!("Episode {}: {}", one.episode, reasons.join(", ")),
        })
    };
    ended.iter().filter_map(chapter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the titles of the chapters of episodes with these goals, optima and changes.
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
        let chapters = chosen(&ended).into_iter();
        chapters.map(|chapter| chapter.title).collect()
    }

    #[test]
    fn turning_points_are_in_order_of_time_and_each_episode_occurs_once() {
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
    fn one_episode_can_have_all_reasons_and_missing_events_are_not_mentioned() {
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
