//! Exports the policy with its maps as a `no_std` Rust module.

mod parts;

use std::fmt::Write;

use super::demanded::{Language, expression};
use super::maps::{MapTable, State};
use super::usage::{Calls, bits, usage};
use crate::agent::pomdp::NEGLIGIBLE;
use crate::agent::{BEGUN_ELSEWHERE, MISLOCALISED};
use crate::export::comments::RUST as COMMENTS;
use crate::export::rust::names;
use crate::export::{Provenance, QuantisedPolicy, WeightedRule};
use parts::{
    EXACT_MOVES, LOCATE_EXACT, LOCATE_NOISY, SETTLE_DOUBLE, SETTLE_WHOLE, SLIPPING_MOVES, TRACKER,
    TYPES, VOTES,
};

/// Rust syntax for conditions.
const RUST: Language = Language {
    of: "c.",
    and: " && ",
};

/// Usage in Rust.
const CALLS: Calls = Calls {
    begin: "create a Tracker::new()",
    step: "let action = tracker.perceive(percept, bumped, rewarded);",
    percept: ", see below",
    none: " None:\ntake ",
};

/// Returns the module.
pub fn text(quantised: &QuantisedPolicy, maps: &MapTable, provenance: &Provenance) -> String {
    let mut text = COMMENTS.head(quantised, provenance);
    let costs = maps.costs(quantised.actions(), 13);
    text.push_str(&COMMENTS.of(&[&usage(&CALLS, maps), "\n", &costs].concat()));
    text.push_str(&bits(&COMMENTS, provenance));
    text.push_str(&figures(quantised, maps, provenance));
    text.push_str(TYPES);
    text.push_str(&table(maps));
    text.push_str(VOTES);
    text.push_str(&rules(quantised, provenance));
    text.push_str(&tracker(maps));
    text
}

fn figures(quantised: &QuantisedPolicy, maps: &MapTable, provenance: &Provenance) -> String {
    let mut text = format!(
        "\n/// The number of actions.\npub const ACTIONS: usize = {};\n/// Their names.\npub const \
         ACTION_NAMES: [&str; ACTIONS] = [{}];\n/// The number of states.\npub const STATES: usize = {};\n\
         /// In place of a state.\npub const GOAL: u16 = u16::MAX;\n/// The number of rewards on the maps.\npub const REWARDS: u8 = {};\n",
        quantised.actions(),
        names(quantised, provenance),
        maps.states().len(),
        maps.rewards()
    );
    if maps.slip > 0.0 {
        let _ = writeln!(
            text,
            "/// The probability that another action is executed.\npub const SLIP: f64 = {:?};",
            maps.slip
        );
    }
    if maps.observation_error > 0.0 {
        let _ = writeln!(
            text,
            "/// The probability that a cell is observed wrongly.\npub const OBSERVATION_ERROR: f64 = {:?};",
            maps.observation_error
        );
    }
    text
}

/// Returns the table of states.
fn table(maps: &MapTable) -> String {
    let mut text = String::from("\n/// All states.\npub static STATE_TABLE: [State; STATES] = [\n");
    for state in maps.states() {
        let State {
            percept,
            x,
            y,
            map,
            collected,
            ..
        } = state;
        let _ = writeln!(
            text,
            "    State {{ next: [{}], percept: {percept:#06x}, x: {x}, y: {y}, map: {map}, collected: {collected} }},",
            state.successors("GOAL")
        );
    }
    text.push_str("];\n");
    text
}

/// Returns the rules as statements.
fn rules(quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
    let mut text = String::new();
    for vote in quantised.votes() {
        let words = provenance.words(&vote.condition);
        let _ = writeln!(text, "    // {words}: {}", provenance.action(vote.action));
        text.push_str(&rule(vote));
    }
    if quantised
        .votes()
        .iter()
        .all(|vote| vote.condition.specificity() == 0)
    {
        text.push_str("    let _ = c;\n");
    }
    text.push_str("    votes.elected()\n}\n");
    text
}

fn rule(vote: &WeightedRule) -> String {
    let WeightedRule { weight, value, .. } = vote;
    let call = format!("votes.add({}, {weight}, {value});", vote.action.index());
    match expression(&vote.condition, &RUST) {
        Some(demands) => format!("    if {demands} {{\n        {call}\n    }}\n"),
        None => format!("    {call}\n"),
    }
}

/// Returns the tracker, with the parts that these maps need.
fn tracker(maps: &MapTable) -> String {
    let (settle, zero, one) = match maps.is_exact() {
        true => (SETTLE_WHOLE, "0", "1"),
        false => (SETTLE_DOUBLE, "0.0", "1.0"),
    };
    let moves = match maps.slip > 0.0 {
        true => SLIPPING_MOVES,
        false => EXACT_MOVES,
    };
    let locate = match maps.observation_error > 0.0 {
        true => LOCATE_NOISY,
        false => LOCATE_EXACT,
    };
    let (bumped, may_lead) = match maps.unfelt {
        true => ("_bumped", "|_, _, _| true"),
        false => (
            "bumped",
            "|from, _, to| (from == usize::from(to)) == bumped",
        ),
    };
    let begin = match maps.begin {
        Some(begin) => {
            format!("core::array::from_fn(|at| if at == {begin} {{ {one} }} else {{ {zero} }})")
        }
        None => format!("[{zero}; STATES]"),
    };
    [settle, TRACKER, locate]
        .concat()
        .replace("{MOVES}", moves)
        .replace("{BUMPED}", bumped)
        .replace("{MAY_LEAD}", may_lead)
        .replace("{BEGIN}", &begin)
        .replace("{ZERO}", zero)
        .replace("{NEGLIGIBLE}", &format!("{NEGLIGIBLE:?}"))
        .replace("{MISLOCALISED}", &format!("{MISLOCALISED:?}"))
        .replace("{BEGUN_ELSEWHERE}", &format!("{BEGUN_ELSEWHERE:?}"))
}
