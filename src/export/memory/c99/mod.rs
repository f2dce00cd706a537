//! Exports the policy with its maps as a C99 header.

mod locate;
mod parts;

use std::fmt::Write;

use locate::{BUMPED, LOCATE_EXACT, LOCATE_NOISY, LOOKS, NOTHING, PERCEIVED};
use parts::{
    COMMON, DOUBLE_WEIGHT, EXACT_MOVES, FOLLOW, PERCEIVE, SETTLE_DOUBLE, SETTLE_WHOLE,
    SLIPPING_MOVES, TYPES, WHOLE_WEIGHT,
};

use super::demanded::{Language, expression};
use super::maps::{MapTable, State};
use super::usage::{Calls, bits, usage};
use crate::agent::pomdp::NEGLIGIBLE;
use crate::agent::{BEGUN_ELSEWHERE, MISLOCALISED};
use crate::export::c99::{FUNCTIONS, IS_GREATER, actions};
use crate::export::comments::C as COMMENTS;
use crate::export::{Provenance, QuantisedPolicy, WeightedRule};

/// C syntax for conditions.
const C: Language = Language {
    of: "c->",
    and: " && ",
};

/// The code that counts votes.
const VOTES: &str = r"
struct xcscr_votes {
    uint64_t value[XCSCR_ACTIONS];
    uint32_t weight[XCSCR_ACTIONS];
};

static inline void xcscr_vote(struct xcscr_votes *votes, uint8_t action, {WEIGHT} weight, {VALUE} value)
{
    votes->value[action] += (uint64_t)value * weight;
    votes->weight[action] += weight;
}

/* Returns the action with the greatest mean value, the first of equals; XCSCR_NO_ACTION without votes. */
static inline int8_t xcscr_elected(const struct xcscr_votes *votes)
{
    int8_t best = XCSCR_NO_ACTION;
    int8_t action;

    for (action = 0; action < XCSCR_ACTIONS; action++) {
        if (votes->weight[action] != 0
            && (best == XCSCR_NO_ACTION
                || xcscr_is_greater(votes->value[action], votes->weight[action],
                                    votes->value[best], votes->weight[best]))) {
            best = action;
        }
    }
    return best;
}

/* Applies the rules. Each matching rule votes for an action with a weight and a value. */
static inline int8_t xcscr_decide(const struct xcscr_context *c)
{
    struct xcscr_votes votes = {{0}, {0}};

";

/// Usage in C.
const CALLS: Calls = Calls {
    begin: "call xcscr_reset(&tracker)",
    step: "action = xcscr_perceive(&tracker, percept, bumped, rewarded);",
    percept: ", see below",
    none: "\nXCSCR_NO_ACTION: take ",
};

const CONTEXT: &str = "\
xcscr_context(&tracker) returns the likeliest cell: x cells to the east of the goal of its map,
y cells to the north.
";

/// Returns the header, followed by `more` code.
pub fn text(
    quantised: &QuantisedPolicy,
    maps: &MapTable,
    provenance: &Provenance,
    more: &str,
) -> String {
    let mut text = String::from("/*\n");
    text.push_str(&COMMENTS.head(quantised, provenance));
    let costs = costs(quantised, maps);
    text.push_str(&COMMENTS.of(&[&usage(&CALLS, maps), CONTEXT, &costs].concat()));
    text.push_str(&bits(&COMMENTS, provenance));
    text.push_str(" */\n#ifndef XCSCR_POLICY_H\n#define XCSCR_POLICY_H\n\n#include <stdint.h>\n\n");
    text.push_str(&figures(quantised, maps));
    text.push_str(&actions(quantised, provenance));
    text.push_str(FUNCTIONS);
    text.push_str(weight(maps));
    text.push_str(TYPES);
    text.push_str(&table(maps));
    text.push_str(IS_GREATER);
    let size = quantised.size();
    let votes = VOTES.replace("{WEIGHT}", &format!("uint{}_t", size.weight));
    text.push_str(&votes.replace("{VALUE}", &format!("uint{}_t", size.value)));
    text.push_str(&rules(quantised, provenance));
    text.push_str(&tracker(maps));
    text.push_str(more);
    text.push_str("\n#endif\n");
    text
}

/// Returns the memory that the policy needs, as lines for the leading comment.
fn costs(quantised: &QuantisedPolicy, maps: &MapTable) -> String {
    let mut text = format!("\n{}", maps.costs(quantised.actions(), 12));
    text.push_str("On an AVR the constants stay in flash memory.\n");
    if !maps.is_exact() {
        text.push_str(
            "Beliefs are bit for bit those of `xcscr evaluate` where a double has 64 bits and each operation is\n\
             rounded (-ffp-contract=off); elsewhere ties between states may be resolved differently.\n",
        );
    }
    text
}

fn figures(quantised: &QuantisedPolicy, maps: &MapTable) -> String {
    let mut text = format!(
        "#define XCSCR_ACTIONS {}\n#define XCSCR_STATES {}\n#define XCSCR_GOAL 65535 /* in place of a state */\n#define XCSCR_REWARDS {} /* on the maps */\n",
        quantised.actions(),
        maps.states().len(),
        maps.rewards()
    );
    if maps.slip > 0.0 {
        let _ = writeln!(
            text,
            "#define XCSCR_SLIP {:?} /* probability that another action is executed */",
            maps.slip
        );
    }
    if maps.observation_error > 0.0 {
        let _ = writeln!(
            text,
            "#define XCSCR_OBSERVATION_ERROR {:?} /* probability that a cell is observed wrongly */",
            maps.observation_error
        );
    }
    text
}

fn weight(maps: &MapTable) -> &'static str {
    match maps.is_exact() {
        true => WHOLE_WEIGHT,
        false => DOUBLE_WEIGHT,
    }
}

/// Returns the table of states.
fn table(maps: &MapTable) -> String {
    let mut text = String::from(
        "\nstatic const struct xcscr_state xcscr_states[XCSCR_STATES] XCSCR_TABLE = {\n",
    );
    for (at, state) in maps.states().iter().enumerate() {
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
            "    {{{{{}}}, {percept:#06x}, {x}, {y}, {map}, {collected}}}, /* {at} */",
            state.successors("XCSCR_GOAL")
        );
    }
    text.push_str("};\n");
    text
}

/// Returns the rules as statements.
fn rules(quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
    let mut text = String::new();
    for vote in quantised.votes() {
        let _ = writeln!(
            text,
            "    /* {}: {} */",
            provenance.words(&vote.condition),
            provenance.action(vote.action)
        );
        text.push_str(&rule(vote));
    }
    if quantised
        .votes()
        .iter()
        .all(|vote| vote.condition.specificity() == 0)
    {
        text.push_str("    (void)c;\n");
    }
    text.push_str("    return xcscr_elected(&votes);\n}\n");
    text
}

fn rule(vote: &WeightedRule) -> String {
    let call = format!(
        "xcscr_vote(&votes, {}, {}u, {}u);",
        vote.action.index(),
        vote.weight,
        vote.value
    );
    match expression(&vote.condition, &C) {
        Some(demands) => format!("    if ({demands}) {{\n        {call}\n    }}\n"),
        None => format!("    {call}\n"),
    }
}

/// Returns the tracker, with the parts that these maps need.
fn tracker(maps: &MapTable) -> String {
    let (settle, moves) = match (maps.is_exact(), maps.slip > 0.0) {
        (true, _) => (SETTLE_WHOLE, EXACT_MOVES),
        (false, false) => (SETTLE_DOUBLE, EXACT_MOVES),
        (false, true) => (SETTLE_DOUBLE, SLIPPING_MOVES),
    };
    let (felt, looks, locate) = match maps.observation_error > 0.0 {
        true if maps.unfelt => (&NOTHING, "", LOCATE_NOISY),
        true => (&BUMPED, "", LOCATE_NOISY),
        false => (&PERCEIVED, LOOKS, LOCATE_EXACT),
    };
    let begin = match maps.begin {
        Some(begin) => format!("at == {begin}"),
        None => "0".to_owned(),
    };
    [settle, COMMON, looks, FOLLOW, locate, PERCEIVE]
        .concat()
        .replace("{MOVES}", moves)
        .replace("{FELT_WORDS}", felt.words)
        .replace("{FELT_TYPES}", felt.types)
        .replace("{FELT_FITS}", felt.fits)
        .replace("{FELT}", felt.names)
        .replace("{IGNORED}", felt.ignored)
        .replace("{BEGIN}", &begin)
        .replace("{NEGLIGIBLE}", &format!("{NEGLIGIBLE:?}"))
        .replace("{MISLOCALISED}", &format!("{MISLOCALISED:?}"))
        .replace("{BEGUN_ELSEWHERE}", &format!("{BEGUN_ELSEWHERE:?}"))
}
