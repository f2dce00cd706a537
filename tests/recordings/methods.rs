//! Recordings of runs of all methods: their size, and the schemas in their channels.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use super::GRID;
use crate::kit::desk::Desk;
use crate::kit::messages::{count, messages};
use crate::kit::schema::fault;
use rayon::prelude::*;
use serde_json::{Value, json};
use xcscr::agent::Method;
use xcscr::record::reader::Recording;

/// Bytes that recordings may take for each cell move.
const MOST: u64 = 4600;

/// A run of a method with the default settings and half of the episodes. What a recording holds
/// besides steps weighs more in it than in a default run.
fn short_run(method: Method) -> Desk {
    let desk = Desk::new();
    let line = format!("maze4 --episodes 90 --method {}", method.name());
    desk.train("run", &line);
    desk
}

#[cfg(feature = "long")]
#[test]
fn a_run_of_any_method_takes_4600_bytes_for_each_cell_move_at_most() {
    Method::ALL.par_iter().for_each(|&method| {
        let desk = short_run(method);
        let files = fs::read_dir(desk.path("run")).unwrap().map(Result::unwrap);
        let recordings = files.filter(|file| file.path().extension().is_some_and(|e| e == "mcap"));
        let bytes: u64 = recordings.map(|file| file.metadata().unwrap().len()).sum();
        let steps = count(&desk.recording("run/run.mcap"), "/step");
        let what = format!("{}: {bytes} bytes for {steps} steps", method.name());
        // No episode can reach the goal in fewer than 10 steps.
        assert!(steps >= 900, "{what}");
        println!("{what}");
        assert!(bytes / steps <= MOST, "{what}");
    });
}

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
    let schema = |data: &[u8]| serde_json::from_slice(data).unwrap();
    json.map(|topic| (topic.name, schema(&topic.schema_data)))
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

/// Holds all messages of a recording against their schemas. Each topic has messages.
#[track_caller]
fn keeps_to_its_schemas(recording: &Recording) {
    let (schemas, mut met) = (schemas(recording), BTreeSet::new());
    for message in messages(recording) {
        let Some(schema) = schemas.get(message.topic()) else {
            continue;
        };
        let json = known(message.topic(), message.json().unwrap());
        let place = (recording.path(), message.topic(), message.time_ns);
        assert_eq!(fault(schema, &json), None, "{place:?}: {json}");
        met.insert(message.topic().to_owned());
    }
    let is_met = |topic: &&String| met.contains(*topic);
    let silent: Vec<_> = schemas.keys().filter(|topic| !is_met(topic)).collect();
    assert!(silent.is_empty(), "{silent:?} in {:?}", recording.path());
}

#[cfg(feature = "long")]
#[test]
fn every_message_of_every_method_is_what_its_schema_says() {
    let check = |desk: Desk| {
        for name in ["ep-0001", "ep-0002", "run"] {
            keeps_to_its_schemas(&desk.recording(&format!("run/{name}.mcap")));
        }
    };
    let methods = Method::ALL.par_iter();
    methods.for_each(|&method| check(short_run(method)));
    let on_the_grid = Desk::new();
    on_the_grid.train("run", GRID);
    check(on_the_grid);
}

fn sample() -> Recording {
    Recording::open(Path::new("recordings/sample-maze4.mcap")).unwrap()
}

#[test]
fn where_null_stands_for_unknown_the_schema_says_so() {
    let schemas = schemas(&sample());
    for (topic, field) in MAY_HOLD_NULL {
        let meaning = &schemas[topic]["properties"][field]["description"];
        let meaning = meaning.as_str().unwrap();
        assert!(meaning.ends_with("null if unknown."), "{meaning}");
    }
}

#[test]
fn a_message_that_breaks_its_schema_is_told_from_one_that_keeps_it() {
    let schema = &schemas(&sample())["/episode"];
    let complete = json!({
        "episode": 1, "outcome": "goal", "steps": 10, "collisions": 0, "explored": 2, "reward": 1.5,
        "rules": 7, "step_threshold": 50, "learning_rate": 0.1, "imprinted": false, "optimal": true,
        "start_values": []
    });
    for (message, expected) in [
        (json!({"episode": 1, "shortest": 3, "reward": 0.5}), ""),
        (
            json!({"episode": null}),
            ".episode: null is not \"integer\"",
        ),
        (json!({"start_values": [1.0, 2]}), ""),
        (
            json!({"generality": null}),
            ".generality: null is not \"number\"",
        ),
        (
            json!({"start_values": [1.0, null]}),
            ".start_values[1]: null is not \"number\"",
        ),
        (json!({"steps": 1.5}), ".steps: 1.5 is not \"integer\""),
        (
            json!({"optimal": "yes"}),
            ".optimal: \"yes\" is not \"boolean\"",
        ),
        (json!({"colour": 1}), ".colour is not in the schema"),
    ] {
        let mut whole = complete.clone();
        whole
            .as_object_mut()
            .unwrap()
            .extend(message.as_object().unwrap().clone());
        let found = fault(schema, &whole).unwrap_or_default();
        assert!(found.starts_with(expected), "{message}: {found}");
        assert_eq!(found.is_empty(), expected.is_empty(), "{message}: {found}");
    }
    for (message, expected) in [
        (json!([]), ": [] is not \"object\""),
        (json!({"episode": 1}), ".outcome is missing"),
    ] {
        assert_eq!(fault(schema, &message).as_deref(), Some(expected));
    }
}
