//! Controls of `check`: what it must find in recordings that are sound but for one fault.

use std::path::Path;

use crate::copies::Parts;
use crate::kit::desk::Desk;
use crate::kit::trial::Trial;
use mcap::WriteOptions;
use xcscr::record::layout;
use xcscr::record::reader::{Message, Recording, TopicInfo};

/// What a recording of an episode in physics is made of.
fn episode() -> Parts {
    let desk = Desk::new();
    let trial = Trial {
        arena: "physics",
        episodes: 1,
        ..Trial::default()
    };
    let files = trial.record(desk.folder()).unwrap().files;
    let mut parts = Parts::of(&Recording::open(&files[0]).unwrap());
    let layout = layout::of_episode(&trial.maze()).into_bytes();
    parts.attached.insert(LAYOUT.to_owned(), layout);
    parts
}

const LAYOUT: &str = "foxglove-layout.json";

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

#[test]
fn a_layout_that_points_at_nothing_is_found() {
    for (there, nowhere) in [("/rule.values", "/rule.wealth"), ("/scene/trail", "/trail")] {
        let mut parts = episode();
        let layout = String::from_utf8(parts.attached[LAYOUT].clone()).unwrap();
        assert!(layout.contains(there), "{layout}");
        let changed = layout.replace(there, nowhere).into_bytes();
        parts.attached.insert(LAYOUT.to_owned(), changed);
        let faults = faults(&parts);
        let fault = format!("the layout shows {nowhere}, but there is no such");
        assert!(
            faults.iter().any(|found| found.starts_with(&fault)),
            "{nowhere}: {faults:?}"
        );
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
fn time_that_runs_backwards_is_found() {
    let mut parts = episode();
    parts.messages_on("/log").last().unwrap().time_ns = 1;
    has_only(&parts, "/log at 1 ns comes after a message at");
}

#[test]
fn a_message_that_is_no_json_is_found() {
    let mut parts = episode();
    parts.messages_on("/step").next().unwrap().data.truncate(9);
    has_only(&parts, "/step at ");
}

#[test]
fn a_message_that_does_not_fit_its_schema_is_found_whatever_its_encoding() {
    for (topic, data) in [
        ("/scene/policy", &b"\xff\xff\xff"[..]),
        ("/scene/policy", b""),
        ("/tf", b"\x0a"),
        ("/tf", b""),
        ("/log", b""),
        ("/step", b"{}"),
        ("/step", br#"{"episode":"one"}"#),
        ("/step", br#"{"colour":1}"#),
        ("/episode", b"[1]"),
    ] {
        let mut parts = episode();
        parts.messages_on(topic).next().unwrap().data = data.to_vec();
        has_only(&parts, &format!("{topic} at "));
    }
}

#[test]
fn a_topic_that_belongs_to_the_robot_of_the_recording_must_be_there() {
    let sample = Recording::open(Path::new("recordings/sample-maze4.mcap")).unwrap();
    let mut parts = Parts::of(&sample);
    assert_eq!(faults(&parts), [""; 0], "control");
    parts.topics.retain(|topic| topic.name != "/estimate");
    parts
        .messages
        .retain(|message| message.topic() != "/estimate");
    has_only(&parts, "the topic /estimate is missing");
}

#[test]
fn a_topic_with_another_schema_or_another_version_of_it_is_found() {
    let with_step = |change: fn(&mut TopicInfo)| {
        let mut parts = episode();
        let mut topics = parts.topics.iter_mut();
        change(topics.find(|topic| topic.name == "/step").unwrap());
        parts
    };
    let renamed = with_step(|topic| topic.schema = "other".to_owned());
    has_only(&renamed, "/step has the schema `other`, expected `");
    // The same JSON with other bytes.
    let changed = with_step(|topic| topic.schema_data.push(b' '));
    has_only(&changed, "/step has another version of the schema");
}

#[test]
fn a_topic_without_a_message_is_found() {
    for topic in ["/step", "/scene/policy", "/tf"] {
        let mut parts = episode();
        parts.messages.retain(|message| message.topic() != topic);
        has_only(&parts, &format!("{topic} has no message"));
    }
}

#[test]
fn a_topic_that_no_recording_of_the_kind_has_is_found() {
    for unknown in ["/foo", "/ended", "/a/step"] {
        let mut parts = episode();
        let step = parts.topics.iter().find(|topic| topic.name == "/step");
        let mut topic = step.unwrap().clone();
        topic.name = unknown.to_owned();
        parts.topics.push(topic);
        has_only(&parts, &format!("the topic {unknown} is unknown"));
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
