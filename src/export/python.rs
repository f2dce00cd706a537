//! The policy as a Python module.

use std::fmt::Write;

use super::{Ballot, Origin, Vote};
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
pub(super) fn text(ballot: &Ballot, origin: &Origin) -> String {
    let mut text = String::new();
    for line in origin.lines() {
        let _ = writeln!(text, "# {line}");
    }
    let _ = writeln!(
        text,
        "# {} rules vote in whole numbers. Compared with the run's own greedy choice in {}: the \
         same.\n\n# What each bit of a percept says when it is 1.\nBITS = [",
        ballot.votes().len(),
        ballot.compared()
    );
    for bit in 0..ballot.width() {
        let _ = writeln!(text, "    {:?},", origin.bit(bit));
    }
    text.push_str("]\n\nACTIONS = [\n");
    for action in Action::all(ballot.actions()) {
        let _ = writeln!(text, "    {:?},", origin.action(action));
    }
    text.push_str("]\n\n# Condition, action, weight, worth.\nRULES = [\n");
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
