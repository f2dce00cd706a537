//! Exports the policy as a Python module.

use std::fmt::Write;

use super::comments::PYTHON as COMMENTS;
use super::{Provenance, QuantisedPolicy, WeightedRule};
use xcs::Action;

/// The part that is the same in every module.
const DECIDE: &str = r##"

def decide(percept):
    """Returns the action for a percept (a string of 0 and 1), the first of equals; None if no rule matches."""
    sums = [[0, 0] for _ in ACTIONS]
    for condition, action, weight, value in RULES:
        if all(wanted in ("#", bit) for wanted, bit in zip(condition, percept)):
            sums[action][0] += value * weight
            sums[action][1] += weight
    best = None
    for action, (value, weight) in enumerate(sums):
        if weight and (best is None or value * sums[best][1] > sums[best][0] * weight):
            best = action
    return best
"##;

/// Returns the module.
pub(super) fn text(quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
    let mut text = COMMENTS.head(quantised, provenance);
    text.push_str("\nimport math\n\n# The meaning of each bit of a percept when it is 1.\n");
    text.push_str(&names(quantised, quantised.width(), provenance));
    text.push_str("\n# Condition, action, weight, value.\nRULES = [\n");
    for WeightedRule {
        condition,
        action,
        value,
        weight,
    } in quantised.votes()
    {
        let action = action.index();
        let _ = writeln!(text, "    (\"{condition}\", {action}, {weight}, {value}),");
    }
    text.push_str("]\n");
    text.push_str(DECIDE);
    text
}

/// Returns the names of `bits` bits and of the actions.
pub(super) fn names(quantised: &QuantisedPolicy, bits: usize, provenance: &Provenance) -> String {
    let bits = (0..bits).map(|bit| provenance.bit(bit));
    let actions = Action::all(quantised.actions()).map(|action| provenance.action(action));
    let lines = |name: String| format!("    {name:?},\n");
    let (bits, actions): (String, String) =
        (bits.map(lines).collect(), actions.map(lines).collect());
    format!("BITS = [\n{bits}]\n\nACTIONS = [\n{actions}]\n")
}
