//! Exports the policy as a `no_std` Rust module.

use std::fmt::Write;

use super::comments::RUST as COMMENTS;
use super::{Provenance, QuantisedPolicy, WeightedRule};
use xcs::Action;

/// The part that is the same in every module.
const DECIDE: &str = r"
/// Returns the action for a percept, the first of equals; `None` if no rule matches.
pub fn decide(percept: &[u8; PERCEPT_BYTES]) -> Option<u8> {
    let mut value = [0_u64; ACTIONS];
    let mut weight = [0_u64; ACTIONS];
    for rule in &RULES {
        let demanded = rule.bits.iter().zip(&rule.care);
        let mut bytes = percept.iter().zip(demanded);
        if bytes.all(|(byte, (bits, care))| (byte ^ bits) & care == 0) {
            value[usize::from(rule.action)] += u64::from(rule.value) * u64::from(rule.weight);
            weight[usize::from(rule.action)] += u64::from(rule.weight);
        }
    }
    let mut best: Option<usize> = None;
    for action in (0..ACTIONS).filter(|&action| weight[action] != 0) {
        let is_greater = |best: usize| {
            u128::from(value[action]) * u128::from(weight[best])
                > u128::from(value[best]) * u128::from(weight[action])
        };
        if best.is_none_or(is_greater) {
            best = Some(action);
        }
    }
    best.map(|action| action as u8)
}
";

/// Returns the module.
pub(super) fn text(quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
    let mut text = COMMENTS.head(quantised, provenance);
    text.push_str(&COMMENTS.bits_of_bytes(quantised, provenance));
    let _ = writeln!(
        text,
        "\n/// Bytes of a percept.\npub const PERCEPT_BYTES: usize = {};\n/// The names of the \
         actions.\npub const ACTION_NAMES: [&str; ACTIONS] = [{}];\n/// The number of actions.\npub \
         const ACTIONS: usize = {};\n",
        quantised.bytes(),
        names(quantised, provenance),
        quantised.actions()
    );
    text.push_str(&table(quantised));
    text.push_str(DECIDE);
    text
}

pub(super) fn names(quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
    let names =
        Action::all(quantised.actions()).map(|action| format!("{:?}", provenance.action(action)));
    names.collect::<Vec<_>>().join(", ")
}

fn table(quantised: &QuantisedPolicy) -> String {
    let size = quantised.size();
    let mut text = format!(
        "struct Rule {{\n    bits: [u8; PERCEPT_BYTES],\n    care: [u8; PERCEPT_BYTES],\n    \
         action: u8,\n    weight: u{},\n    value: u{},\n}}\n\nstatic RULES: [Rule; {}] = [\n",
        size.weight,
        size.value,
        quantised.votes().len()
    );
    for vote in quantised.votes() {
        let _ = writeln!(text, "    {},", row(quantised, vote));
    }
    text.push_str("];\n");
    text
}

fn row(quantised: &QuantisedPolicy, vote: &WeightedRule) -> String {
    let (bits, care) = quantised.condition_bytes(&vote.condition);
    let WeightedRule { weight, value, .. } = vote;
    let action = vote.action.index();
    format!(
        "Rule {{ bits: {bits:?}, care: {care:?}, action: {action}, weight: {weight}, \
         value: {value} }}"
    )
}
