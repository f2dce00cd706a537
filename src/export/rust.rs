//! The policy as a Rust module without the standard library.

use std::fmt::Write;

use super::comments::RUST as COMMENTS;
use super::{Ballot, Provenance, Vote};
use xcs::Action;

/// What is the same in every module.
const DECIDE: &str = r"
/// The action for a percept, the first of equals; `None` where no rule matches.
pub fn decide(percept: &[u8; PERCEPT_BYTES]) -> Option<u8> {
    let mut worth = [0_u64; ACTIONS];
    let mut weight = [0_u64; ACTIONS];
    for rule in &RULES {
        let demanded = rule.value.iter().zip(&rule.care);
        let mut bytes = percept.iter().zip(demanded);
        if bytes.all(|(byte, (value, care))| (byte ^ value) & care == 0) {
            worth[usize::from(rule.action)] += u64::from(rule.worth) * u64::from(rule.weight);
            weight[usize::from(rule.action)] += u64::from(rule.weight);
        }
    }
    let mut best: Option<usize> = None;
    for action in (0..ACTIONS).filter(|&action| weight[action] != 0) {
        let is_greater = |best: usize| {
            u128::from(worth[action]) * u128::from(weight[best])
                > u128::from(worth[best]) * u128::from(weight[action])
        };
        if best.is_none_or(is_greater) {
            best = Some(action);
        }
    }
    best.map(|action| action as u8)
}
";

/// The module.
pub(super) fn text(ballot: &Ballot, provenance: &Provenance) -> String {
    let mut text = COMMENTS.head(ballot, provenance);
    text.push_str(&COMMENTS.bits_of_bytes(ballot, provenance));
    let _ = writeln!(
        text,
        "\n/// Bytes of a percept.\npub const PERCEPT_BYTES: usize = {};\n/// The names of the \
         actions.\npub const ACTION_NAMES: [&str; ACTIONS] = [{}];\n/// The number of actions.\npub \
         const ACTIONS: usize = {};\n",
        ballot.bytes(),
        names(ballot, provenance),
        ballot.actions()
    );
    text.push_str(&table(ballot));
    text.push_str(DECIDE);
    text
}

pub(super) fn names(ballot: &Ballot, provenance: &Provenance) -> String {
    let names =
        Action::all(ballot.actions()).map(|action| format!("{:?}", provenance.action(action)));
    names.collect::<Vec<_>>().join(", ")
}

fn table(ballot: &Ballot) -> String {
    let size = ballot.size();
    let mut text = format!(
        "struct Rule {{\n    value: [u8; PERCEPT_BYTES],\n    care: [u8; PERCEPT_BYTES],\n    \
         action: u8,\n    weight: u{},\n    worth: u{},\n}}\n\nstatic RULES: [Rule; {}] = [\n",
        size.weight,
        size.worth,
        ballot.votes().len()
    );
    for vote in ballot.votes() {
        let _ = writeln!(text, "    {},", row(ballot, vote));
    }
    text.push_str("];\n");
    text
}

fn row(ballot: &Ballot, vote: &Vote) -> String {
    let (value, care) = ballot.condition_bytes(&vote.condition);
    let Vote { weight, worth, .. } = vote;
    let action = vote.action.index();
    format!(
        "Rule {{ value: {value:?}, care: {care:?}, action: {action}, weight: {weight}, \
         worth: {worth} }}"
    )
}
