//! How to use a filter, and what it takes.

use super::places::Filter;
use crate::export::Ballot;

/// How a language calls it.
pub struct Calls {
    /// What is done at the beginning of an episode.
    pub begin: &'static str,
    /// What is done in each step.
    pub step: &'static str,
    /// No action.
    pub none: &'static str,
}

/// What the program of a robot must do, as lines for a comment.
pub fn usage(calls: &Calls) -> String {
    let Calls { begin, step, none } = calls;
    format!(
        "
Percepts may be misread. A filter knows places, by what they look like, and what came of each action
there; it believes where the robot may be, and asks the rules what to do in the likeliest place.
At the beginning of an episode {begin}, then in each step
    {step}
percept   what is perceived, right or not: see below
bumped    did the last action end at a wall, so that the robot stands where it was? In the first
          step of an episode it means nothing
Where no rule matches, the action is {none}: take any. Whoever does another action than
this one writes it into filter.action. Rewards do not matter to the filter. It no longer learns: it
is that of `xcscr evaluate`.
"
    )
}

/// What it takes as constants, and as memory, as lines for a comment.
pub fn costs(ballot: &Ballot, filter: &Filter) -> String {
    let (places, lines) = (filter.met() + 1, filter.lines().count());
    let place = (23 + 4 * ballot.actions() + ballot.bytes()).next_multiple_of(8);
    format!(
        "
The filter takes {} bytes of constants ({places} places of {place} bytes, {lines} lines of 8 bytes on what came
of actions, {} doubles), and {} bytes of memory. No allocation, no recursion, no libm.
",
        places * place + 8 * lines + 8 * filter.looks.len(),
        filter.looks.len(),
        16 * places + 8
    )
}

/// Where beliefs are exactly those of the learner.
pub const ROUNDING: &str = "\
Beliefs are bit for bit those of `xcscr evaluate` where a double has 64 bits and each operation is
rounded (-ffp-contract=off); elsewhere places that are equally likely may be told apart otherwise.
";
