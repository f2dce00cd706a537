//! Controls of `check`: what it must find in recordings that are sound but for one fault.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use crate::kit::trial::Trial;
use mcap::Attachment;
use mcap::records::{MessageHeader, Metadata};
use xcscr::record::FindingKind;
use xcscr::record::layout;
use xcscr::record::reader::{Message, Recording};

/// What a copy of a sound recording is made of.
struct Parts {
    sound: Recording,
    attached: BTreeMap<&'static str, String>,
    messages: Vec<Message>,
    /// A topic that a copy lacks.
    left_out: Option<&'static str>,
}

impl Parts {
    /// Those of an episode in physics.
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let trial = Trial {
            arena: "physics",
            episodes: 1,
            ..Trial::default()
        };
        let files = trial.record(folder.path()).unwrap().files;
        let mut parts = Self::of(Recording::open(&files[0]).unwrap());
        let layout = layout::of_episode(&trial.maze());
        parts.attached.insert("foxglove-layout.json", layout);
        parts
    }

    /// Those of a recording.
    fn of(sound: Recording) -> Self {
        let messages = sound.messages().map(|message| message.unwrap()).collect();
        let names = ["world.json", "config.json", "foxglove-layout.json"];
        let attached = names.into_iter().filter_map(|name| {
            let text = sound.attachment(name)?.to_vec();
            Some((name, String::from_utf8(text).unwrap()))
        });
        Self {
            attached: attached.collect(),
            sound,
            messages,
            left_out: None,
        }
    }

    fn messages_on(&mut self, topic: &str) -> impl Iterator<Item = &mut Message> {
        let all = self.messages.iter_mut();
        all.filter(move |message| message.topic() == topic)
    }

    /// The kinds of faults that a copy has.
    fn faults(&self) -> Vec<FindingKind> {
        let bytes = self.copy().unwrap();
        let copy = Recording::from_bytes(Path::new("copy.mcap"), bytes).unwrap();
        let found = copy.check();
        found.into_iter().map(|finding| finding.kind).collect()
    }

    fn copy(&self) -> mcap::McapResult<Vec<u8>> {
        let mut writer = mcap::Writer::new(Cursor::new(Vec::new()))?;
        let metadata = self.sound.metadata("run").unwrap().clone();
        let name = "run".to_owned();
        writer.write_metadata(&Metadata { name, metadata })?;
        for (name, text) in &self.attached {
            writer.attach(&Attachment {
                log_time: 0,
                create_time: 0,
                name: (*name).to_owned(),
                media_type: "application/json".to_owned(),
                data: text.as_bytes().into(),
            })?;
        }
        let mut channels = BTreeMap::new();
        let topics = self.sound.topics().into_iter();
        let topics = topics.filter(|topic| Some(topic.name.as_str()) != self.left_out);
        for topic in topics {
            let language = if topic.encoding == "json" {
                "jsonschema"
            } else {
                "protobuf"
            };
            let schema = writer.add_schema(&topic.schema, language, &topic.schema_data)?;
            let none = BTreeMap::new();
            let channel = writer.add_channel(schema, &topic.name, &topic.encoding, &none)?;
            channels.insert(topic.name, channel);
        }
        for message in &self.messages {
            let header = MessageHeader {
                channel_id: channels[message.topic()],
                sequence: 0,
                log_time: message.time_ns,
                publish_time: message.time_ns,
            };
            writer.write_to_known_channel(&header, &message.data)?;
        }
        writer.finish()?;
        Ok(writer.into_inner().into_inner())
    }
}

#[test]
fn a_faithful_copy_is_sound() {
    assert_eq!(Parts::new().faults(), []);
}

#[test]
fn a_layout_that_points_at_nothing_is_found() {
    for (there, nowhere) in [("/rule.values", "/rule.wealth"), ("/scene/trail", "/trail")] {
        let mut parts = Parts::new();
        let layout = parts.attached.get_mut("foxglove-layout.json").unwrap();
        assert!(layout.contains(there), "{layout}");
        *layout = layout.replace(there, nowhere);
        let faults = parts.faults();
        assert!(
            faults.contains(&FindingKind::Layout),
            "{nowhere}: {faults:?}"
        );
    }
}

#[test]
fn a_world_that_is_missing_is_found() {
    let mut parts = Parts::new();
    parts.attached.remove("world.json");
    assert!(parts.faults().contains(&FindingKind::Facts));
}

#[test]
fn a_robot_that_is_not_seen_for_a_while_is_found() {
    let mut parts = Parts::new();
    let end_ns = parts.messages_on("/tf").last().unwrap().time_ns;
    let seen = |m: &Message| m.topic() != "/tf" || m.time_ns == 0 || m.time_ns == end_ns;
    parts.messages.retain(seen);
    assert_eq!(parts.faults(), [FindingKind::Gap]);
}

#[test]
fn time_that_runs_backwards_is_found() {
    let mut parts = Parts::new();
    parts.messages_on("/log").last().unwrap().time_ns = 1;
    assert_eq!(parts.faults(), [FindingKind::Order]);
}

#[test]
fn a_message_that_is_no_json_is_found() {
    let mut parts = Parts::new();
    parts.messages_on("/step").next().unwrap().data.truncate(9);
    assert_eq!(parts.faults(), [FindingKind::Message]);
}

#[test]
fn a_message_that_does_not_fit_its_schema_is_found_whatever_its_encoding() {
    for (topic, data) in [
        ("/scene/policy", &b"\xff\xff\xff"[..]),
        ("/tf", b"\x0a"),
        ("/step", br#"{"episode":"one"}"#),
        ("/step", br#"{"colour":1}"#),
        ("/episode", b"[1]"),
    ] {
        let mut parts = Parts::new();
        parts.messages_on(topic).next().unwrap().data = data.to_vec();
        assert_eq!(parts.faults(), [FindingKind::Message], "{topic}: {data:?}");
    }
}

#[test]
fn a_topic_that_belongs_to_the_robot_of_the_recording_must_be_there() {
    let sample = || Recording::open(Path::new("recordings/sample-maze4.mcap")).unwrap();
    assert_eq!(Parts::of(sample()).faults(), [], "control");
    let mut parts = Parts::of(sample());
    parts.left_out = Some("/estimate");
    parts
        .messages
        .retain(|message| message.topic() != "/estimate");
    assert_eq!(parts.faults(), [FindingKind::Topic]);
}
