//! Exports the policy as a C99 header.

use std::fmt::Write;

use super::comments::C as COMMENTS;
use super::{Provenance, QuantisedPolicy, WeightedRule};
use xcs::Action;

/// The part that is the same in every header: how to read a table.
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

/// The comparison of mean values.
pub(super) const IS_GREATER: &str = r#"
/* Returns 1 if the mean values_a / weight_a is greater than values_b / weight_b. Computes in 96 bits. */
static inline int xcscr_is_greater(uint64_t values_a, uint32_t weight_a,
                                   uint64_t values_b, uint32_t weight_b)
{
    const uint64_t low_a = (values_a & 0xffffffffu) * weight_b;
    const uint64_t low_b = (values_b & 0xffffffffu) * weight_a;
    const uint64_t high_a = (values_a >> 32) * weight_b + (low_a >> 32);
    const uint64_t high_b = (values_b >> 32) * weight_a + (low_b >> 32);
    if (high_a != high_b) {
        return high_a > high_b;
    }
    return (low_a & 0xffffffffu) > (low_b & 0xffffffffu);
}
"#;

const DECIDE: &str = r#"
/* Returns the action for a percept, the first of equals; XCSCR_NO_ACTION if no rule matches. */
static inline int8_t xcscr_decide(const uint8_t percept[XCSCR_PERCEPT_BYTES])
{
    uint64_t value[XCSCR_ACTIONS] = {0};
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
            wrong = (uint8_t)(wrong | ((percept[byte] ^ rule.bits[byte]) & rule.care[byte]));
        }
        if (wrong == 0) {
            value[rule.action] += (uint64_t)rule.value * rule.weight;
            weight[rule.action] += rule.weight;
        }
    }
    for (action = 0; action < XCSCR_ACTIONS; action++) {
        if (weight[action] != 0
            && (best == XCSCR_NO_ACTION
                || xcscr_is_greater(value[action], weight[action], value[best], weight[best]))) {
            best = action;
        }
    }
    return best;
}
"#;

/// Returns the header, followed by `more` code.
pub(super) fn text(quantised: &QuantisedPolicy, provenance: &Provenance, more: &str) -> String {
    let mut text = String::from("/*\n");
    text.push_str(&COMMENTS.head(quantised, provenance));
    text.push_str(&COMMENTS.bits_of_bytes(quantised, provenance));
    text.push_str(" */\n#ifndef XCSCR_POLICY_H\n#define XCSCR_POLICY_H\n\n#include <stdint.h>\n\n");
    let figures = [
        ("PERCEPT_BITS", quantised.width()),
        ("PERCEPT_BYTES", quantised.bytes()),
        ("ACTIONS", quantised.actions()),
        ("RULES", quantised.votes().len()),
    ];
    for (name, value) in figures {
        let _ = writeln!(text, "#define XCSCR_{name} {value}");
    }
    text.push_str(&actions(quantised, provenance));
    text.push_str(FUNCTIONS);
    text.push_str(&table(quantised));
    text.push_str(IS_GREATER);
    text.push_str(DECIDE);
    text.push_str(more);
    text.push_str("\n#endif\n");
    text
}

/// Returns the constants for the actions.
pub(super) fn actions(quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
    let mut text = String::from("#define XCSCR_NO_ACTION (-1)\n\n");
    for action in Action::all(quantised.actions()) {
        let name = provenance
            .action(action)
            .to_uppercase()
            .replace(['-', ' '], "_");
        let _ = writeln!(text, "#define XCSCR_ACTION_{name} {}", action.index());
    }
    text
}

/// Returns the type of a rule and the table of rules.
fn table(quantised: &QuantisedPolicy) -> String {
    let size = quantised.size();
    let mut text = format!(
        "\nstruct xcscr_rule {{\n    uint8_t bits[XCSCR_PERCEPT_BYTES];\n    \
         uint8_t care[XCSCR_PERCEPT_BYTES];\n    uint8_t action;\n    uint{}_t weight;\n    \
         uint{}_t value;\n}};\n\nstatic const struct xcscr_rule xcscr_rules[XCSCR_RULES] XCSCR_TABLE = {{\n",
        size.weight, size.value
    );
    for vote in quantised.votes() {
        let _ = writeln!(text, "    {},", row(quantised, vote));
    }
    text.push_str("};\n");
    text
}

fn row(quantised: &QuantisedPolicy, vote: &WeightedRule) -> String {
    let (bits, care) = quantised.condition_bytes(&vote.condition);
    let bytes = |bytes: &[u8]| {
        let bytes: Vec<String> = bytes.iter().map(|byte| format!("0x{byte:02x}")).collect();
        bytes.join(", ")
    };
    format!(
        "{{{{{}}}, {{{}}}, {}, {}u, {}u}}",
        bytes(&bits),
        bytes(&care),
        vote.action.index(),
        vote.weight,
        vote.value
    )
}
