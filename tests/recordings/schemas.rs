//! Every JSON message is what the schema in its channel says.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crate::kit::program::expect;
use crate::kit::schema::fault;
use serde_json::{Value, json};
use xcscr::agent::Method;
use xcscr::record::reader::Recording;

/// Arrays in which `null` stands for what is unknown. A schema cannot say so: viewers refuse one
/// whose items have two types. Their meaning says it instead.
const MAY_HOLD_NULL: [(&str, &str); 3] = [
    ("/episode", "start_values"),
    ("/rule", "values"),
    ("/step", "values"),
];

/// The topics of a recording that carry JSON, with their schemas.
fn schemas(recording: &Recording) -> BTreeMap<String, Value> {
    let topics = recording.topics().into_iter();
    let json = topics.filter(|topic| topic.encoding == "json");
    json.map(|topic| {
        let schema = serde_json::from_slice(&topic.schema_data).unwrap();
        (topic.name, schema)
    })
    .collect()
}

/// A message without the nulls that stand for what is unknown.
fn known(topic: &str, mut message: Value) -> Value {
    for (_, field) in MAY_HOLD_NULL.iter().filter(|(of, _)| *of == topic) {
        if let Some(Value::Array(items)) = message.get_mut(field) {
            items.retain(|item| !item.is_null());
        }
    }
    message
}

/// Holds all messages of a recording against their schemas; gives the topics that were met.
#[track_caller]
fn keeps_to_its_schemas(recording: &Recording) -> BTreeSet<String> {
    let (schemas, mut met) = (schemas(recording), BTreeSet::new());
    for message in recording.messages().map(|message| message.unwrap()) {
        let Some(schema) = schemas.get(message.topic()) else {
            continue;
        };
        let json = known(message.topic(), message.json().unwrap());
        let fault = fault(schema, &json);
        let place = (recording.path(), message.topic(), message.time_ns);
        assert_eq!(fault, None, "{place:?}: {json}");
        met.insert(message.topic().to_owned());
    }
    met
}

/// The recordings of a short run, with its highlights.
fn recordings(run: &Path, more: &[&str]) -> Vec<Recording> {
    let out = ["--quiet", "--episodes", "3", "--out", run.to_str().unwrap()];
    expect(
        0,
        &[&["train", "worlds/maze4.json"], &out[..], more].concat(),
    );
    let files = fs::read_dir(run)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let recordings = files.filter(|file| file.extension().is_some_and(|e| e == "mcap"));
    let recordings: Vec<_> = recordings
        .map(|file| Recording::open(&file).unwrap())
        .collect();
    assert_eq!(
        recordings.len(),
        5,
        "three episodes, the run and its highlights"
    );
    recordings
}

#[test]
fn every_message_of_every_method_is_what_its_schema_says() {
    let folder = tempfile::tempdir().unwrap();
    // What a robot senses is the same with all methods, and on the grid there is nothing of it.
    let runs = Method::ALL.iter().map(|method| (method.name(), "grid"));
    let (mut met, mut declared) = (BTreeSet::new(), BTreeSet::new());
    for (method, arena) in runs.chain([("xcscr-plus", "physics")]) {
        let run = folder.path().join(format!("{method}-{arena}"));
        for recording in recordings(&run, &["--method", method, "--arena", arena]) {
            met.extend(keeps_to_its_schemas(&recording));
            declared.extend(schemas(&recording).into_keys());
        }
    }
    assert!(met == declared && met.len() >= 7, "{met:?}, {declared:?}");
}

#[test]
fn where_null_stands_for_unknown_the_schema_of_highlights_says_so() {
    let highlights = Recording::open(Path::new("recordings/sample-maze4.mcap")).unwrap();
    let schemas = schemas(&highlights);
    keeps_to_its_schemas(&highlights);
    for (topic, field) in MAY_HOLD_NULL {
        let meaning = &schemas[topic]["properties"][field]["description"];
        assert!(
            meaning.as_str().unwrap().ends_with("null: unknown"),
            "{meaning}"
        );
    }
}

#[test]
fn a_message_that_breaks_its_schema_is_told_from_one_that_keeps_it() {
    let highlights = Recording::open(Path::new("recordings/sample-maze4.mcap")).unwrap();
    let schema = &schemas(&highlights)["/episode"];
    let faults = [
        (json!({"episode": 1, "state": 3, "reward": 0.5}), None),
        (json!({"start_values": [1.0, 2]}), None),
        (
            json!({"generality": null}),
            Some(".generality: null is not \"number\""),
        ),
        (
            json!({"start_values": [1.0, null]}),
            Some(".start_values[1]: null is not \"number\""),
        ),
        (
            json!({"steps": 1.5}),
            Some(".steps: 1.5 is not \"integer\""),
        ),
        (json!({"state": 2}), Some(".state: 2 is none of")),
        (
            json!({"optimal": "yes"}),
            Some(".optimal: \"yes\" is not \"boolean\""),
        ),
        (json!({"colour": 1}), Some(".colour is not in the schema")),
        (json!([]), Some(": [] is not \"object\"")),
    ];
    for (message, expected) in faults {
        let found = fault(schema, &message);
        match expected {
            Some(start) => assert!(found.as_ref().unwrap().starts_with(start), "{found:?}"),
            None => assert_eq!(found, None, "{message}"),
        }
    }
}
