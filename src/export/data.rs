//! The policy as data: CSV and JSON.

use serde::Serialize;

use super::memory::Charts;
use super::provenance::Facts;
use super::{Ballot, Policy, Provenance, Vote};
use xcs::Action;

/// A rule of the table.
#[derive(Serialize)]
struct Row {
    condition: String,
    action: usize,
    weight: u32,
    worth: u32,
    #[serde(rename = "if")]
    words: String,
    go: String,
}

/// The whole policy.
#[derive(Serialize)]
struct Document<'a> {
    origin: &'a Facts,
    /// In what it was compared with the run's own greedy choice.
    compared: String,
    /// What each bit of a percept, or with a memory of a context, says when it is 1.
    bits: Vec<String>,
    actions: Vec<String>,
    rules: Vec<Row>,
    /// The charts that rules with a memory go by.
    #[serde(skip_serializing_if = "Option::is_none")]
    charts: Option<&'a Charts>,
}

fn rows(ballot: &Ballot, provenance: &Provenance) -> impl Iterator<Item = Row> {
    ballot.votes().iter().map(|vote: &Vote| Row {
        condition: vote.condition.to_string(),
        action: vote.action.index(),
        weight: vote.weight,
        worth: vote.worth,
        words: provenance.words(&vote.condition),
        go: provenance.action(vote.action),
    })
}

/// One row per rule.
pub(super) fn csv(ballot: &Ballot, provenance: &Provenance) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows(ballot, provenance) {
        writer.serialize(row).expect("rows of texts and numbers");
    }
    let bytes = writer.into_inner().expect("a vector takes all");
    String::from_utf8(bytes).expect("texts and numbers")
}

/// One document.
pub(super) fn json(policy: &Policy, provenance: &Provenance) -> String {
    let ballot = policy.ballot();
    let document = Document {
        origin: &provenance.facts,
        compared: ballot.compared(),
        bits: (0..ballot.width()).map(|bit| provenance.bit(bit)).collect(),
        actions: Action::all(ballot.actions())
            .map(|a| provenance.action(a))
            .collect(),
        rules: rows(ballot, provenance).collect(),
        charts: policy.charts(),
    };
    let text = serde_json::to_string_pretty(&document).expect("texts and numbers");
    text + "\n"
}
