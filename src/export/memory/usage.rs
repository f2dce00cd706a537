//! The instructions for using a tracker.

use super::maps::MapTable;
use crate::agent::PERCEPT_BITS;
use crate::export::Provenance;
use crate::export::comments::Comments;

/// The calls in a language.
pub struct Calls {
    /// The call at the beginning of an episode.
    pub begin: &'static str,
    /// The call in each step.
    pub step: &'static str,
    /// A reference to the description of percepts.
    pub percept: &'static str,
    /// The value for no action, between `the action is` and `any`.
    pub none: &'static str,
}

/// Returns the instructions for the robot's program, as lines for a comment.
pub fn usage(calls: &Calls, maps: &MapTable) -> String {
    let Calls {
        begin,
        step,
        percept,
        none,
    } = calls;
    let bumped = match maps.unfelt {
        true => "is ignored: the rules were learned without it",
        false => "whether the last action ended at a wall, so that the robot did not move",
    };
    format!(
        "
The rules use maps of the world, on which a tracker localises the robot. At the beginning of an
episode {begin}, then in each step
    {step}
percept   the eight cells around the robot{percept}
bumped    {bumped}
rewarded  whether the last action found a reward other than the goal
In the first step of an episode, bumped and rewarded are ignored. Where no rule matches, the action is{none}any. \
A program that executes another action writes it into tracker.action.
"
    )
}

/// Lists the bits of a percept that is a number.
pub fn bits(comments: &Comments, provenance: &Provenance) -> String {
    let number = |bit: usize| format!("{:#06x}", 1 << bit);
    comments.bits(PERCEPT_BITS, provenance, "", number)
}
