//! Exports the policy as data: CSV and JSON.

use serde::Serialize;

use super::memory::MapTable;
use super::provenance::Facts;
use super::{Policy, Provenance, QuantisedPolicy, WeightedRule};
use xcs::Action;

/// A rule of the table.
#[derive(Serialize)]
struct Row {
    condition: String,
    action: usize,
    weight: u32,
    value: u32,
    #[serde(rename = "if")]
    words: String,
    go: String,
}

/// The whole policy.
#[derive(Serialize)]
struct Document<'a> {
    origin: &'a Facts,
    /// The number of inputs in which the export was compared with the greedy choice of the run.
    compared: String,
    /// The meaning of each bit of a percept when it is 1; for rules with a map, of each bit of a
    /// context.
    bits: Vec<String>,
    actions: Vec<String>,
    rules: Vec<Row>,
    /// The maps of rules with a map.
    #[serde(skip_serializing_if = "Option::is_none")]
    maps: Option<&'a MapTable>,
}

fn rows(quantised: &QuantisedPolicy, provenance: &Provenance) -> impl Iterator<Item = Row> {
    quantised.votes().iter().map(|vote: &WeightedRule| Row {
        condition: vote.condition.to_string(),
        action: vote.action.index(),
        weight: vote.weight,
        value: vote.value,
        words: provenance.words(&vote.condition),
        go: provenance.action(vote.action),
    })
}

/// Returns a CSV table with a row for each rule.
pub(super) fn csv(quantised: &QuantisedPolicy, provenance: &Provenance) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows(quantised, provenance) {
        writer.serialize(row).expect("rows of texts and numbers");
    }
    let bytes = writer.into_inner().expect("a vector takes all");
    String::from_utf8(bytes).expect("texts and numbers")
}

/// Returns a JSON document.
pub(super) fn json(policy: &Policy, provenance: &Provenance) -> String {
    let quantised = policy.quantised();
    let document = Document {
        origin: &provenance.facts,
        compared: quantised.compared(),
        bits: (0..quantised.width())
            .map(|bit| provenance.bit(bit))
            .collect(),
        actions: Action::all(quantised.actions())
            .map(|a| provenance.action(a))
            .collect(),
        rules: rows(quantised, provenance).collect(),
        maps: policy.maps(),
    };
    let text = serde_json::to_string_pretty(&document).expect("texts and numbers");
    text + "\n"
}
