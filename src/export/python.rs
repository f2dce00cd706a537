//! The policy as a Python module.

use std::fmt::Write;

use super::comments::PYTHON as COMMENTS;
use super::{Ballot, Provenance, Vote};
use xcs::Action;

/// What is the same in every module.
const DECIDE: &str = r##"

def decide(percept):
    """The action for a percept (a string of 0 and 1), the first of equals; None where no rule matches."""
    sums = [[0, 0] for _ in ACTIONS]
    for condition, action, weight, worth in RULES:
        if all(wanted in ("#", bit) for wanted, bit in zip(condition, percept)):
            sums[action][0] += worth * weight
            sums[action][1] += weight
    best = None
    for action, (worth, weight) in enumerate(sums):
        if weight and (best is None or worth * sums[best][1] > sums[best][0] * weight):
            best = action
    return best
"##;

/// The module.
pub(super) fn text(ballot: &Ballot, provenance: &Provenance) -> String {
    let mut text = COMMENTS.head(ballot, provenance);
    text.push_str("\nimport math\n\n# What each bit of a percept says when it is 1.\n");
    text.push_str(&names(ballot, ballot.width(), provenance));
    text.push_str("\n# Condition, action, weight, worth.\nRULES = [\n");
    for Vote {
        condition,
        action,
        worth,
        weight,
    } in ballot.votes()
    {
        let action = action.index();
        let _ = writeln!(text, "    (\"{condition}\", {action}, {weight}, {worth}),");
    }
    text.push_str("]\n");
    text.push_str(DECIDE);
    text
}

/// The names of so many bits, and of the actions.
pub(super) fn names(ballot: &Ballot, bits: usize, provenance: &Provenance) -> String {
    let bits = (0..bits).map(|bit| provenance.bit(bit));
    let actions = Action::all(ballot.actions()).map(|action| provenance.action(action));
    let lines = |name: String| format!("    {name:?},\n");
    let (bits, actions): (String, String) =
        (bits.map(lines).collect(), actions.map(lines).collect());
    format!("BITS = [\n{bits}]\n\nACTIONS = [\n{actions}]\n")
}
