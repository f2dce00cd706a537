//! What is wrong with a recording.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;

use super::reader::{Message, Recording};
use crate::record::error::RecordError;
use crate::record::info::RecordingKind;
use crate::record::json::json_tree;
use crate::record::layout;
use crate::record::mode::RecordMode;
use crate::record::topics::Topic;
use crate::trial::Config;
use crate::world::Maze;

/// Gaps between messages with poses up to this long are normal: each shows two seconds of the way.
const LONGEST_GAP_NS: u64 = 2_000_000_000;
/// What every recording carries.
const ATTACHED: [&str; 2] = ["world.json", "config.json"];
/// What a recording of a whole run or of highlights carries in addition.
const ATTACHED_TO_RUN: [&str; 1] = ["foxglove-layout.json"];

/// The most faults that are listed: a small file can hold hundreds of thousands.
const MOST_LISTED: usize = 1_000;

/// Something that is wrong with a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// What kind of fault it is.
    pub kind: FindingKind,
    /// What exactly was found, and where.
    pub what: String,
}

/// The kinds of faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// It cannot be read: unfinished, no MCAP file, or a wrong checksum.
    Unreadable,
    /// The index at the end says something else than the file itself.
    Index,
    /// An attachment or a metadata record is missing.
    Facts,
    /// A topic or its schema is missing or another.
    Topic,
    /// A message does not fit its schema.
    Message,
    /// Time runs backwards.
    Order,
    /// The robot's pose is missing for a while.
    Gap,
    /// The layout points at something that does not exist.
    Layout,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what)
    }
}

/// Checks a file; an empty list means that it is sound.
///
/// # Errors
/// [`RecordError::Read`] when there is no such file. What is wrong *in* it is a finding.
pub fn check(path: &Path) -> Result<Vec<Finding>, RecordError> {
    match Recording::open(path) {
        Ok(recording) => Ok(recording.check()),
        Err(error @ RecordError::Read { .. }) => Err(error),
        // This is the command that says more.
        Err(RecordError::Damaged { cause, .. }) => Ok(vec![finding(
            FindingKind::Unreadable,
            format!("this recording is damaged: {cause}"),
        )]),
        Err(error) => Ok(vec![finding(FindingKind::Unreadable, error.to_string())]),
    }
}

impl Recording {
    /// Checks the recording; an empty list means that it is sound.
    pub fn check(&self) -> Vec<Finding> {
        let mut findings = Vec::new();
        check_facts(self, &mut findings);
        check_topics(self, &mut findings);
        check_messages(self, &mut findings);
        check_layout(self, &mut findings);
        findings
    }
}

fn finding(kind: FindingKind, what: String) -> Finding {
    Finding { kind, what }
}

fn check_facts(recording: &Recording, findings: &mut Vec<Finding>) {
    for name in &attachments(recording.extent()) {
        let data = recording.attachment(name);
        let what = match data.map(serde_json::from_slice::<serde::de::IgnoredAny>) {
            None => format!("the attachment {name} is missing"),
            Some(Err(error)) => format!("the attachment {name} is not JSON: {error}"),
            Some(Ok(_)) => continue,
        };
        findings.push(finding(FindingKind::Facts, what));
    }
    if recording.metadata("run").is_none() {
        let what = "the metadata record `run` is missing";
        findings.push(finding(FindingKind::Facts, what.to_owned()));
    }
}

/// What is attached to such a recording.
fn attachments(extent: Option<RecordingKind>) -> Vec<String> {
    let below = |side: &str| ATTACHED.map(|name| format!("{side}{name}"));
    let facts = match extent {
        Some(RecordingKind::Comparison) => layout::SIDES
            .map(|side| below(&format!("{side}/")))
            .concat(),
        _ => below("").to_vec(),
    };
    let of_run: &[&str] = match extent {
        Some(RecordingKind::Run | RecordingKind::Highlights | RecordingKind::Comparison) => {
            &ATTACHED_TO_RUN
        }
        _ => &[],
    };
    let of_run = of_run.iter().map(|name| (*name).to_owned());
    facts.into_iter().chain(of_run).collect()
}

/// The topic without the side of a comparison that it belongs to.
fn plain(topic: &str) -> &str {
    let sides = layout::SIDES.iter();
    let mut stripped = sides.filter_map(|side| topic.strip_prefix('/')?.strip_prefix(side));
    let stripped = stripped.find(|rest| rest.starts_with('/'));
    stripped.unwrap_or(topic)
}

fn check_topics(recording: &Recording, findings: &mut Vec<Finding>) {
    // What does not say what it is may be an episode.
    let extent = recording.extent().unwrap_or(RecordingKind::Episode(1));
    if extent != RecordingKind::Comparison {
        return check_side("", extent, recording, findings);
    }
    for side in layout::SIDES {
        check_side(
            &format!("/{side}"),
            RecordingKind::Highlights,
            recording,
            findings,
        );
    }
}

/// Does the robot estimate where it is, and are the beams of its lidar recorded? As the facts of a recording, or of a side of
/// a comparison, say.
fn sensing(side: &str, recording: &Recording) -> [bool; 2] {
    let side = side.trim_start_matches('/');
    let (config, facts) = match side {
        "" => ("config.json".to_owned(), "run"),
        side => (format!("{side}/config.json"), side),
    };
    let config = recording.attachment(&config);
    let config: Option<Config> = config.and_then(|text| serde_json::from_slice(text).ok());
    let mode = recording
        .metadata(facts)
        .and_then(|facts| facts.get("record"));
    let beams = mode.is_some_and(|mode| mode.parse() == Ok(RecordMode::Beams));
    [config.is_some_and(|config| config.senses()), beams]
}

/// The topics of a recording, or of a side of a comparison.
fn check_side(
    side: &str,
    extent: RecordingKind,
    recording: &Recording,
    findings: &mut Vec<Finding>,
) {
    let present = recording.topics();
    let expected = if extent == RecordingKind::Run {
        Topic::of_run()
    } else {
        let [senses, beams] = sensing(side, recording);
        Topic::of_episode(senses, beams && extent != RecordingKind::Highlights)
    };
    for topic in expected {
        let name = format!("{side}{}", topic.name());
        let schema = topic.schema(extent);
        let what = match present.iter().find(|found| found.name == name) {
            None => format!("the topic {name} is missing"),
            Some(found) if found.schema != schema.name => {
                format!(
                    "{name} has the schema `{}`, expected `{}`",
                    found.schema, schema.name
                )
            }
            Some(found) if found.schema_data != *schema.data => {
                format!("{name} has another version of the schema `{}`", schema.name)
            }
            Some(_) => continue,
        };
        findings.push(finding(FindingKind::Topic, what));
    }
}

fn check_messages(recording: &Recording, findings: &mut Vec<Finding>) {
    let (mut before_ns, mut posed_ns) = (0, BTreeMap::new());
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    for message in recording.messages() {
        let message = match message {
            Ok(message) => message,
            Err(error) => {
                return findings.push(finding(FindingKind::Unreadable, error.to_string()));
            }
        };
        if findings.len() >= MOST_LISTED {
            let what = format!("there are more faults than these {}", findings.len());
            return findings.push(finding(FindingKind::Message, what));
        }
        let (topic, now_ns) = (message.topic(), message.time_ns);
        *counts.entry(topic.to_owned()).or_default() += 1;
        if now_ns < before_ns {
            let what = format!("{topic} at {now_ns} ns comes after a message at {before_ns} ns");
            findings.push(finding(FindingKind::Order, what));
        }
        before_ns = now_ns;
        if let Some(fault) = fault(&message) {
            let what = format!("{topic} at {now_ns} ns {fault}");
            findings.push(finding(FindingKind::Message, what));
        }
        if plain(topic) == Topic::Transforms.name() {
            let before = posed_ns.insert(topic.to_owned(), now_ns);
            if let Some(before) = before.filter(|&before| now_ns > before + LONGEST_GAP_NS) {
                let what = format!("no pose on {topic} from {before} ns to {now_ns} ns");
                findings.push(finding(FindingKind::Gap, what));
            }
        }
    }
    check_index(recording, &counts, findings);
}

/// What is wrong with a message, as far as its schema tells.
fn fault(message: &Message) -> Option<String> {
    match Topic::named(plain(message.topic())) {
        Some(topic) => topic.fault(&message.data),
        None if message.encoding() == "json" && message.json().is_none() => {
            Some("is not JSON".to_owned())
        }
        None => None,
    }
}

/// The index must count the messages that there are.
fn check_index(recording: &Recording, counts: &BTreeMap<String, u64>, findings: &mut Vec<Finding>) {
    for (name, claimed) in recording.claimed() {
        let found = counts.get(&name).copied().unwrap_or(0);
        if found != claimed {
            let what = format!("{name} has {found} messages, the index says {claimed}");
            findings.push(finding(FindingKind::Index, what));
        }
    }
    let chunks = &recording.summary().chunk_indexes;
    if chunks.is_empty() && counts.values().sum::<u64>() > 0 {
        let what = "no chunk is indexed, so that a viewer finds no message";
        findings.push(finding(FindingKind::Index, what.to_owned()));
    }
}

fn check_layout(recording: &Recording, findings: &mut Vec<Finding>) {
    let Some(layout) = layout_of(recording) else {
        return;
    };
    let fields: BTreeMap<String, BTreeSet<String>> = recording
        .topics()
        .into_iter()
        .map(|topic| (topic.name, json_fields(&topic.schema_data)))
        .collect();
    for path in layout::paths(&layout) {
        let is_of_senses = Topic::named(plain(&path.topic)).is_some_and(Topic::is_of_senses);
        let what = match fields.get(&path.topic) {
            None if is_of_senses => continue,
            None => format!("the layout shows {path}, but there is no such topic"),
            Some(known) if path.field.as_ref().is_some_and(|f| !known.contains(f)) => {
                format!("the layout shows {path}, but there is no such field")
            }
            Some(_) => continue,
        };
        findings.push(finding(FindingKind::Layout, what));
    }
}

/// The layout that lies beside a recording, if its world can be read.
fn layout_of(recording: &Recording) -> Option<Vec<u8>> {
    if let Some(attached) = recording.attachment("foxglove-layout.json") {
        return Some(attached.to_vec());
    }
    let world = recording.attachment("world.json")?;
    let maze = Maze::from_json(world, "world.json").ok()?;
    Some(layout::of_episode(&maze).into_bytes())
}

/// The fields that a JSON schema has; none for other schemas.
fn json_fields(schema: &[u8]) -> BTreeSet<String> {
    let schema = json_tree(schema).unwrap_or_default();
    let properties = schema["properties"].as_object();
    properties
        .into_iter()
        .flatten()
        .map(|(name, _)| name.clone())
        .collect()
}
