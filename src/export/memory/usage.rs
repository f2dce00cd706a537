//! How to use a tracker.

use super::maps::MapTable;
use crate::agent::PERCEPT_BITS;
use crate::export::Provenance;
use crate::export::comments::Comments;

/// How a language calls it.
pub struct Calls {
    /// What is done at the beginning of an episode.
    pub begin: &'static str,
    /// What is done in each step.
    pub step: &'static str,
    /// Where more is said about percepts.
    pub percept: &'static str,
    /// No action, between `the action is` and `any`.
    pub none: &'static str,
}

/// What the program of a robot must do, as lines for a comment.
pub fn usage(calls: &Calls, maps: &MapTable) -> String {
    let Calls {
        begin,
        step,
        percept,
        none,
    } = calls;
    let bumped = match maps.unfelt {
        true => "is not looked at: it was learned without",
        false => "did the last action end at a wall, so that the robot stands where it was?",
    };
    format!(
        "
The rules go by maps of the world: a tracker follows the robot on them. At the beginning of an
episode {begin}, then in each step
    {step}
percept   the eight cells around the robot{percept}
bumped    {bumped}
rewarded  did it find a reward other than the goal?
In the first step of an episode the last two mean nothing. Where no rule matches, the action is{none}any. \
Whoever does another action than this one writes it into tracker.action.
"
    )
}

/// What the bits of a percept say that is a number.
pub fn bits(comments: &Comments, provenance: &Provenance) -> String {
    let number = |bit: usize| format!("{:#06x}", 1 << bit);
    comments.bits(PERCEPT_BITS, provenance, "", number)
}
