//! Exports the policy as a graph for Graphviz.

use std::fmt::Write;

use super::{Provenance, QuantisedPolicy};
use xcs::Action;

/// Returns a graph with the rules in words on the left and their actions on the right. The width of
/// an arrow shows the value.
pub(super) fn text(quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
    let mut text = String::new();
    for line in provenance.lines() {
        let _ = writeln!(text, "// {line}");
    }
    text.push_str("digraph policy {\n  rankdir=LR;\n  node [shape=box];\n");
    for action in Action::all(quantised.actions()) {
        let name = quoted(&provenance.action(action));
        let _ = writeln!(
            text,
            "  action{} [label={name}, shape=ellipse];",
            action.index()
        );
    }
    let most = quantised.votes().iter().map(|vote| vote.value).max();
    for (at, vote) in quantised.votes().iter().enumerate() {
        let words = quoted(&provenance.words(&vote.condition).replace(", ", "\n"));
        let share = f64::from(vote.value) / f64::from(most.unwrap_or(0).max(1));
        let _ = writeln!(text, "  rule{at} [label={words}];");
        let _ = writeln!(
            text,
            "  rule{at} -> action{} [penwidth={:.1}, label=\"{:.0} %\"];",
            vote.action.index(),
            1.0 + 3.0 * share,
            100.0 * share
        );
    }
    text.push_str("}\n");
    text
}

/// Quotes a text for DOT.
fn quoted(text: &str) -> String {
    let text = text
        .replace('\\', "\\\\")
        .replace('"', "\\\"")
        .replace('\n', "\\n");
    format!("\"{text}\"")
}
