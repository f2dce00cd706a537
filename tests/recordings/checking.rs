//! Controls of `check`: what it must find in recordings that are sound but for one fault.

use std::collections::BTreeSet;
use std::path::Path;

use crate::kit::desk::Desk;
use crate::kit::trial::{Trial, maze};
use crate::recordings::copies::{Parts, merged};
use mcap::WriteOptions;
use serde_json::Value;
use xcscr::record::layout;
use xcscr::record::reader::{Message, Recording, TopicInfo};
use xcscr::world::Maze;

/// What a recording of an episode in physics is made of.
fn episode() -> Parts {
    let desk = Desk::new();
    let trial = Trial {
        arena: "physics",
        episodes: 1,
        ..Trial::default()
    };
    let files = trial.record(desk.folder()).unwrap().files;
    Parts::of(&Recording::open(&files[0]).unwrap())
}

/// The faults that a copy has.
fn faults(parts: &Parts) -> Vec<String> {
    let bytes = parts.write(WriteOptions::new());
    let copy = Recording::from_bytes(Path::new("copy.mcap"), bytes).unwrap();
    copy.check()
}

/// A copy has one fault, and it is this one.
#[track_caller]
fn has_only(parts: &Parts, fault: &str) {
    let faults = faults(parts);
    assert!(faults.len() == 1 && faults[0].contains(fault), "{faults:?}");
}

#[test]
fn a_faithful_copy_is_sound() {
    assert_eq!(faults(&episode()), [""; 0]);
}

/// Adds everything that the panels of a layout show: topics, and fields of them.
fn shown(value: &Value, paths: &mut BTreeSet<String>) {
    match value {
        Value::String(text) if text.starts_with('/') => drop(paths.insert(text.clone())),
        Value::Array(list) => list.iter().for_each(|one| shown(one, paths)),
        Value::Object(fields) => {
            let names = fields.keys().filter(|name| name.starts_with('/'));
            paths.extend(names.cloned());
            fields.values().for_each(|one| shown(one, paths));
        }
        _ => {}
    }
}

/// Returns the paths of a layout that a recording has not.
fn missing(recording: &Recording, layout: &str) -> Vec<String> {
    let layout: Value = serde_json::from_str(layout).unwrap();
    let mut paths = BTreeSet::new();
    shown(&layout["configById"], &mut paths);
    assert!(paths.len() > 10, "{paths:?}");
    let topics = recording.topics();
    let is_known = |path: &String| {
        let (topic, field) = path.split_once('.').unwrap_or((path, ""));
        let topic = topics.iter().find(|one| one.name == topic);
        let schema = |topic: &TopicInfo| -> Value {
            serde_json::from_slice(&topic.schema_data).unwrap_or_default()
        };
        let field = field.split('[').next().unwrap();
        topic
            .is_some_and(|topic| field.is_empty() || schema(topic)["properties"][field].is_object())
    };
    paths.into_iter().filter(|path| !is_known(path)).collect()
}

#[test]
fn layouts_show_only_topics_and_fields_that_recordings_have() {
    let desk = Desk::new();
    desk.train("run", "maze4 --episodes 2 --record beams");
    let maze = maze("maze4");
    let (episode, run) = (
        desk.recording("run/ep-0001.mcap"),
        desk.recording("run/run.mcap"),
    );
    let layouts = [layout::of_episode(&maze), layout::of_run(&maze)];
    assert_eq!(missing(&episode, &layouts[0]), [""; 0]);
    assert_eq!(missing(&run, &layouts[1]), [""; 0]);
    for (there, nowhere) in [("/rule.values", "/rule.wealth"), ("/scene/trail", "/trail")] {
        let changed = layouts[0].replace(there, nowhere);
        let missing = missing(&episode, &changed);
        assert!(
            !missing.is_empty() && missing.iter().all(|one| one.starts_with(nowhere)),
            "{missing:?}"
        );
    }
}

#[test]
fn every_3d_panel_shows_the_greedy_path_of_a_very_large_maze() {
    let (wall, cells) = ("#".repeat(41), ".".repeat(37));
    let world = serde_json::json!({ "rows": [wall, format!("#S{cells}G#"), wall] }).to_string();
    let maze = Maze::from_json(world.as_bytes(), "corridor.json").unwrap();
    for (text, panels) in [(layout::of_episode(&maze), 2), (layout::of_run(&maze), 1)] {
        let layout: Value = serde_json::from_str(&text).unwrap();
        let all = layout["configById"].as_object().unwrap();
        let scenes = all.iter().filter(|(id, _)| id.starts_with("3D!"));
        let path = scenes.map(|(_, panel)| &panel["topics"]["/scene/policy"]["visible"]);
        let shown = path.filter(|&visible| visible == true).count();
        assert_eq!(shown, panels, "{text}");
    }
}

#[test]
fn a_world_that_is_missing_is_found() {
    let mut parts = episode();
    parts.attached.remove("world.json");
    let missing = "the attachment world.json is missing".to_owned();
    assert!(faults(&parts).contains(&missing));
}

#[test]
fn a_robot_that_is_not_seen_for_a_while_is_found() {
    let mut parts = episode();
    let end_ns = parts.messages_on("/tf").last().unwrap().time_ns;
    let seen = |m: &Message| m.topic() != "/tf" || m.time_ns == 0 || m.time_ns == end_ns;
    parts.messages.retain(seen);
    has_only(&parts, "no pose on /tf from 0 ns");
}

#[test]
fn the_end_of_time_is_a_time() {
    let mut parts = episode();
    parts.messages_on("/tf").last().unwrap().time_ns = u64::MAX;
    parts.messages.sort_by_key(|message| message.time_ns);
    let faults = faults(&parts);
    assert!(
        faults.iter().any(|fault| fault.contains("no pose on /tf")),
        "{faults:?}"
    );
}

#[test]
fn time_that_runs_backwards_is_found() {
    let mut parts = episode();
    parts.messages_on("/log").last().unwrap().time_ns = 1;
    has_only(&parts, "/log at 1 ns comes after a message at");
}

#[test]
fn a_topic_that_belongs_to_the_robot_of_the_recording_must_be_there() {
    let sample = Recording::open(Path::new("recordings/sample-maze4.mcap")).unwrap();
    let mut parts = Parts::of(&sample);
    assert_eq!(faults(&parts), [""; 0], "control");
    parts.topics.retain(|topic| topic.name != "/localisation");
    parts
        .messages
        .retain(|message| message.topic() != "/localisation");
    has_only(&parts, "the topic /localisation is missing");
}

#[test]
fn a_topic_with_another_schema_is_found() {
    let with_step = |change: fn(&mut TopicInfo)| {
        let mut parts = episode();
        let mut topics = parts.topics.iter_mut();
        change(topics.find(|topic| topic.name == "/step").unwrap());
        parts
    };
    let renamed = with_step(|topic| topic.schema = "other".to_owned());
    has_only(&renamed, "/step has the schema `other`, expected `");
}

#[test]
fn a_topic_without_a_message_is_found() {
    for topic in ["/step", "/scene/policy", "/ground_truth"] {
        let mut parts = episode();
        parts.messages.retain(|message| message.topic() != topic);
        has_only(&parts, &format!("{topic} has no message"));
    }
}

#[test]
fn a_run_of_an_unknown_kind_is_found_and_not_taken_for_a_training() {
    let mut parts = episode();
    parts.run.insert("kind".to_owned(), "dream".to_owned());
    has_only(&parts, "a run of the unknown kind `dream`");
    let desk = Desk::new();
    desk.write("copy.mcap", parts.write(WriteOptions::new()));
    desk.fails(65, "map @copy.mcap -o @x.svg", "unknown kind `dream`");
}

#[test]
fn merged_recordings_are_read_or_refused_with_the_reason_and_never_called_damaged() {
    let desk = Desk::new();
    desk.train("run", "maze4 --episodes 2");
    let parts = |name: &str| Parts::of(&desk.recording(name));
    desk.write("one.mcap", merged(&[parts("run/ep-0001.mcap")]));
    for (name, others) in [
        ("two.mcap", ["run/ep-0001.mcap", "run/ep-0002.mcap"]),
        ("all.mcap", ["run/ep-0001.mcap", "run/run.mcap"]),
    ] {
        desk.write(name, merged(&others.map(parts)));
        let (info, _) = desk.run(0, &format!("recording info @{name}"));
        assert!(info.contains("/tf"), "{info}");
        let said = desk.fails(
            1,
            &format!("recording verify @{name}"),
            "differs from a new run",
        );
        assert!(!said.contains("damaged"), "{said}");
        for line in ["map @FILE -o @x.svg", "replay --html @x.html @FILE"] {
            let said = desk.fails(
                65,
                &line.replace("FILE", name),
                "was merged from several recordings",
            );
            assert!(!said.contains("damaged"), "{said}");
        }
    }
    // Control: a copy by another program is whole, but has other bytes.
    let (stdout, _) = desk.run(1, "recording verify @one.mcap");
    assert!(
        stdout.contains("another program wrote one of them"),
        "{stdout}"
    );
    desk.ok("recording check @one.mcap");
    desk.ok("replay --html @x.html @one.mcap");
}

#[test]
fn a_recording_without_a_summary_is_read_and_not_called_damaged() {
    let parts = episode();
    let options = WriteOptions::new()
        .emit_summary_offsets(false)
        .emit_statistics(false);
    let options = options
        .emit_chunk_indexes(false)
        .emit_attachment_indexes(false)
        .emit_metadata_indexes(false);
    let options = options.repeat_channels(false).repeat_schemas(false);
    let bytes = parts.write(options);
    let copy = Recording::from_bytes(Path::new("copy.mcap"), bytes).unwrap();
    assert_eq!(copy.topics().len(), parts.topics.len());
    let faults = copy.check();
    assert!(
        faults
            .iter()
            .any(|fault| fault.contains("no chunk is indexed")),
        "{faults:?}"
    );
}
