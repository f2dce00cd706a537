//! The policy as a C99 header.

use std::fmt::Write;

use super::comments::C as COMMENTS;
use super::{Ballot, Provenance, Vote};
use xcs::Action;

/// What is the same in every header: reading a table.
pub(super) const FUNCTIONS: &str = r#"
/* On an AVR the table stays in flash memory. */
#if defined(__AVR__)
#include <avr/pgmspace.h>
#define XCSCR_TABLE PROGMEM
#define XCSCR_READ(to, from) memcpy_P(&(to), &(from), sizeof(to))
#else
#define XCSCR_TABLE
#define XCSCR_READ(to, from) ((to) = (from))
#endif
"#;

/// Comparing worths.
pub(super) const IS_GREATER: &str = r#"
/* Is the mean worth_a / weight_a greater than worth_b / weight_b? In 96 bits. */
static inline int xcscr_is_greater(uint64_t worth_a, uint32_t weight_a,
                                   uint64_t worth_b, uint32_t weight_b)
{
    const uint64_t low_a = (worth_a & 0xffffffffu) * weight_b;
    const uint64_t low_b = (worth_b & 0xffffffffu) * weight_a;
    const uint64_t high_a = (worth_a >> 32) * weight_b + (low_a >> 32);
    const uint64_t high_b = (worth_b >> 32) * weight_a + (low_b >> 32);
    if (high_a != high_b) {
        return high_a > high_b;
    }
    return (low_a & 0xffffffffu) > (low_b & 0xffffffffu);
}
"#;

const DECIDE: &str = r#"
/* The action for a percept, the first of equals; XCSCR_NO_ACTION where no rule matches. */
static inline int8_t xcscr_decide(const uint8_t percept[XCSCR_PERCEPT_BYTES])
{
    uint64_t worth[XCSCR_ACTIONS] = {0};
    uint32_t weight[XCSCR_ACTIONS] = {0};
    int8_t best = XCSCR_NO_ACTION;
    int8_t action;
    uint16_t at;

    for (at = 0; at < XCSCR_RULES; at++) {
        struct xcscr_rule rule;
        uint8_t wrong = 0;
        uint8_t byte;
        XCSCR_READ(rule, xcscr_rules[at]);
        for (byte = 0; byte < XCSCR_PERCEPT_BYTES; byte++) {
            wrong = (uint8_t)(wrong | ((percept[byte] ^ rule.value[byte]) & rule.care[byte]));
        }
        if (wrong == 0) {
            worth[rule.action] += (uint64_t)rule.worth * rule.weight;
            weight[rule.action] += rule.weight;
        }
    }
    for (action = 0; action < XCSCR_ACTIONS; action++) {
        if (weight[action] != 0
            && (best == XCSCR_NO_ACTION
                || xcscr_is_greater(worth[action], weight[action], worth[best], weight[best]))) {
            best = action;
        }
    }
    return best;
}
"#;

/// The header; it ends with `more` code.
pub(super) fn text(ballot: &Ballot, provenance: &Provenance, more: &str) -> String {
    let mut text = String::from("/*\n");
    text.push_str(&COMMENTS.head(ballot, provenance));
    text.push_str(&COMMENTS.bits_of_bytes(ballot, provenance));
    text.push_str(" */\n#ifndef XCSCR_POLICY_H\n#define XCSCR_POLICY_H\n\n#include <stdint.h>\n\n");
    let figures = [
        ("PERCEPT_BITS", ballot.width()),
        ("PERCEPT_BYTES", ballot.bytes()),
        ("ACTIONS", ballot.actions()),
        ("RULES", ballot.votes().len()),
    ];
    for (name, value) in figures {
        let _ = writeln!(text, "#define XCSCR_{name} {value}");
    }
    text.push_str(&actions(ballot, provenance));
    text.push_str(FUNCTIONS);
    text.push_str(&table(ballot));
    text.push_str(IS_GREATER);
    text.push_str(DECIDE);
    text.push_str(more);
    text.push_str("\n#endif\n");
    text
}

/// The names of the actions.
pub(super) fn actions(ballot: &Ballot, provenance: &Provenance) -> String {
    let mut text = String::from("#define XCSCR_NO_ACTION (-1)\n\n");
    for action in Action::all(ballot.actions()) {
        let name = provenance
            .action(action)
            .to_uppercase()
            .replace(['-', ' '], "_");
        let _ = writeln!(text, "#define XCSCR_ACTION_{name} {}", action.index());
    }
    text
}

/// The type of a rule, and all of them.
fn table(ballot: &Ballot) -> String {
    let size = ballot.size();
    let mut text = format!(
        "\nstruct xcscr_rule {{\n    uint8_t value[XCSCR_PERCEPT_BYTES];\n    \
         uint8_t care[XCSCR_PERCEPT_BYTES];\n    uint8_t action;\n    uint{}_t weight;\n    \
         uint{}_t worth;\n}};\n\nstatic const struct xcscr_rule xcscr_rules[XCSCR_RULES] XCSCR_TABLE = {{\n",
        size.weight, size.worth
    );
    for vote in ballot.votes() {
        let _ = writeln!(text, "    {},", row(ballot, vote));
    }
    text.push_str("};\n");
    text
}

fn row(ballot: &Ballot, vote: &Vote) -> String {
    let (value, care) = ballot.condition_bytes(&vote.condition);
    let bytes = |bytes: &[u8]| {
        let bytes: Vec<String> = bytes.iter().map(|byte| format!("0x{byte:02x}")).collect();
        bytes.join(", ")
    };
    format!(
        "{{{{{}}}, {{{}}}, {}, {}u, {}u}}",
        bytes(&value),
        bytes(&care),
        vote.action.index(),
        vote.weight,
        vote.worth
    )
}
