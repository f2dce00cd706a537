//! The policy with its charts as a Rust module without the standard library.

mod parts;

use std::fmt::Write;

use super::charts::{Charts, State};
use super::demanded::{Language, expression};
use super::usage::{Calls, bits, usage};
use crate::agent::pomdp::NEGLIGIBLE;
use crate::agent::{ASTRAY, BEGUN_ELSEWHERE};
use crate::export::comments::RUST as COMMENTS;
use crate::export::rust::names;
use crate::export::{Ballot, Provenance, Vote};
use parts::{
    EXACT_MOVES, LOCATE_DOUBTINGLY, LOCATE_RIGHTLY, SETTLE_DOUBLE, SETTLE_WHOLE, SLIPPING_MOVES,
    TRACKER, TYPES, VOTES,
};

/// How Rust writes demands.
const RUST: Language = Language {
    of: "c.",
    and: " && ",
};

/// How to use it.
const CALLS: Calls = Calls {
    begin: "make a Tracker::new()",
    step: "let action = tracker.perceive(percept, bumped, rewarded);",
    percept: ", see below",
    none: " None:\ntake ",
};

/// The module.
pub fn text(ballot: &Ballot, charts: &Charts, provenance: &Provenance) -> String {
    let mut text = COMMENTS.head(ballot, provenance);
    let costs = charts.costs(ballot.actions(), 13);
    text.push_str(&COMMENTS.of(&[&usage(&CALLS, charts), "\n", &costs].concat()));
    text.push_str(&bits(&COMMENTS, provenance));
    text.push_str(&figures(ballot, charts, provenance));
    text.push_str(TYPES);
    text.push_str(&table(charts));
    text.push_str(VOTES);
    text.push_str(&rules(ballot, provenance));
    text.push_str(&tracker(charts));
    text
}

fn figures(ballot: &Ballot, charts: &Charts, provenance: &Provenance) -> String {
    let mut text = format!(
        "\n/// The number of actions.\npub const ACTIONS: usize = {};\n/// Their names.\npub const \
         ACTION_NAMES: [&str; ACTIONS] = [{}];\n/// The number of states.\npub const STATES: usize = {};\n\
         /// In place of a state.\npub const GOAL: u16 = u16::MAX;\n/// How many rewards the map knows.\npub const REWARDS: u8 = {};\n",
        ballot.actions(),
        names(ballot, provenance),
        charts.states().len(),
        charts.rewards()
    );
    if charts.slip > 0.0 {
        let _ = writeln!(
            text,
            "/// How likely another action is executed instead.\npub const SLIP: f64 = {:?};",
            charts.slip
        );
    }
    if charts.misread > 0.0 {
        let _ = writeln!(
            text,
            "/// How likely a cell is misread.\npub const MISREAD: f64 = {:?};",
            charts.misread
        );
    }
    text
}

/// All states.
fn table(charts: &Charts) -> String {
    let mut text = String::from("\n/// All states.\npub static CHARTS: [State; STATES] = [\n");
    for state in charts.states() {
        let State {
            percept,
            x,
            y,
            chart,
            collected,
            ..
        } = state;
        let _ = writeln!(
            text,
            "    State {{ next: [{}], percept: {percept:#06x}, x: {x}, y: {y}, chart: {chart}, collected: {collected} }},",
            state.successors("GOAL")
        );
    }
    text.push_str("];\n");
    text
}

/// The rules as statements.
fn rules(ballot: &Ballot, provenance: &Provenance) -> String {
    let mut text = String::new();
    for vote in ballot.votes() {
        let words = provenance.words(&vote.condition);
        let _ = writeln!(text, "    // {words}: {}", provenance.action(vote.action));
        text.push_str(&rule(vote));
    }
    if ballot
        .votes()
        .iter()
        .all(|vote| vote.condition.specificity() == 0)
    {
        text.push_str("    let _ = c;\n");
    }
    text.push_str("    votes.elected()\n}\n");
    text
}

fn rule(vote: &Vote) -> String {
    let Vote { weight, worth, .. } = vote;
    let call = format!("votes.add({}, {weight}, {worth});", vote.action.index());
    match expression(&vote.condition, &RUST) {
        Some(demands) => format!("    if {demands} {{\n        {call}\n    }}\n"),
        None => format!("    {call}\n"),
    }
}

/// The tracker, of the parts that these charts need.
fn tracker(charts: &Charts) -> String {
    let (settle, zero, one) = match charts.is_exact() {
        true => (SETTLE_WHOLE, "0", "1"),
        false => (SETTLE_DOUBLE, "0.0", "1.0"),
    };
    let moves = match charts.slip > 0.0 {
        true => SLIPPING_MOVES,
        false => EXACT_MOVES,
    };
    let locate = match charts.misread > 0.0 {
        true => LOCATE_DOUBTINGLY,
        false => LOCATE_RIGHTLY,
    };
    let (bumped, may_lead) = match charts.unfelt {
        true => ("_bumped", "|_, _, _| true"),
        false => (
            "bumped",
            "|from, _, to| (from == usize::from(to)) == bumped",
        ),
    };
    let begin = match charts.begin {
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
        .replace("{ASTRAY}", &format!("{ASTRAY:?}"))
        .replace("{BEGUN_ELSEWHERE}", &format!("{BEGUN_ELSEWHERE:?}"))
}
