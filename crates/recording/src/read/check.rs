//! Checks of recordings.

use std::collections::BTreeMap;
use std::path::Path;

use super::reader::Recording;
use crate::disk;
use crate::error::Error;
use crate::fault;
use crate::info::{RecordingKind, RunKind};
use crate::mode::RecordMode;
use crate::topics::Topic;
use xcscr_learner::trial::Config;

/// The longest normal gap between poses.
const MAX_GAP_NS: u64 = 2_000_000_000;
/// The attachments of every recording.
const ATTACHED: [&str; 2] = ["world.json", "config.json"];
/// The additional attachment of all recordings but those of single episodes.
const LAYOUT: &str = "foxglove-layout.json";

/// The maximum number of listed faults: a small file can contain hundreds of thousands.
const MAX_LISTED: usize = 1_000;

/// Checks a file. Returns each fault and its position. An empty list means that the file is valid.
///
/// # Errors
/// If the file cannot be read. Faults inside the file are findings.
pub fn check(path: &Path) -> Result<Vec<String>, Error> {
    let bytes = disk::read(path, disk::MOST_BYTES).map_err(fault::cannot_read(path))?;
    match Recording::from_bytes(path, bytes) {
        Ok(recording) => Ok(recording.check()),
        // Omits the error's advice to run this command.
        Err(error) => Ok(vec![fault::without_advice(&error)]),
    }
}

impl Recording {
    /// Checks the recording. Returns each fault and its position. An empty list means that the
    /// recording is valid.
    pub fn check(&self) -> Vec<String> {
        let mut findings = Vec::new();
        check_facts(self, &mut findings);
        check_topics(self, &mut findings);
        check_messages(self, &mut findings);
        findings
    }
}

fn check_facts(recording: &Recording, findings: &mut Vec<String>) {
    let mut names = ATTACHED.to_vec();
    let kind = recording.extent();
    if kind.is_some_and(|kind| kind.episode().is_none()) {
        names.push(LAYOUT);
    }
    for name in names {
        let data = recording.attachment(name);
        let what = match data.map(serde_json::from_slice::<serde::de::IgnoredAny>) {
            None => format!("the attachment {name} is missing"),
            Some(Err(error)) => format!("the attachment {name} is not JSON: {error}"),
            Some(Ok(_)) => continue,
        };
        findings.push(what);
    }
    if recording.metadata("run").is_none() {
        let what = "the metadata record `run` is missing";
        findings.push(what.to_owned());
    }
    findings.extend(recording.run_kind().err().map(|error| error.to_string()));
}

/// Returns true if an external agent finished no episode. All other recordings have an episode.
fn has_no_episode(recording: &Recording) -> bool {
    let is_external = matches!(recording.run_kind(), Ok(RunKind::External));
    is_external && recording.topics().iter().all(|topic| topic.messages == 0)
}

/// Returns whether the robot estimates its pose, and whether its lidar beams are recorded.
fn sensing(recording: &Recording) -> [bool; 2] {
    let config = recording.attachment("config.json");
    let config: Option<Config> = config.and_then(|text| serde_json::from_slice(text).ok());
    let mode = recording
        .metadata("run")
        .and_then(|facts| facts.get("record"));
    let beams = mode.is_some_and(|mode| mode.parse() == Ok(RecordMode::Beams));
    [config.is_some_and(|config| config.senses()), beams]
}

/// Checks that the recording has the topics of its kind, and messages on them. A recording without a
/// kind is checked as an episode.
fn check_topics(recording: &Recording, findings: &mut Vec<String>) {
    let kind = recording.extent().unwrap_or(RecordingKind::Episode(1));
    let (present, is_empty) = (recording.topics(), has_no_episode(recording));
    let expected = if kind == RecordingKind::Run {
        Topic::of_run()
    } else {
        let [senses, beams] = sensing(recording);
        Topic::of_episode(senses, beams)
    };
    for topic in expected {
        let name = topic.name();
        let schema = topic.schema();
        let found = present.iter().find(|found| found.name == name);
        let what = match found {
            None => format!("the topic {name} is missing"),
            Some(found) if found.schema != schema.name => {
                let (found, expected) = (&found.schema, &schema.name);
                format!("{name} has the schema `{found}`, expected `{expected}`")
            }
            Some(found) if found.messages == 0 && topic.is_never_silent() && !is_empty => {
                format!("{name} has no message")
            }
            Some(_) => continue,
        };
        findings.push(what);
    }
}

fn check_messages(recording: &Recording, findings: &mut Vec<String>) {
    let (mut before_ns, mut posed_ns) = (0, None);
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    for message in recording.messages() {
        let message = match message {
            Ok(message) => message,
            Err(error) => {
                return findings.push(error.to_string());
            }
        };
        if findings.len() >= MAX_LISTED {
            let what = format!("there are more faults than these {}", findings.len());
            return findings.push(what);
        }
        let (topic, now_ns) = (message.topic(), message.time_ns);
        *counts.entry(topic.to_owned()).or_default() += 1;
        if now_ns < before_ns {
            let what = format!("{topic} at {now_ns} ns comes after a message at {before_ns} ns");
            findings.push(what);
        }
        before_ns = now_ns;
        if topic == Topic::Transforms.name() {
            let before = posed_ns.replace(now_ns);
            let is_gap = |before: &u64| now_ns.saturating_sub(*before) > MAX_GAP_NS;
            if let Some(before) = before.filter(is_gap) {
                let what = format!("no pose on {topic} from {before} ns to {now_ns} ns");
                findings.push(what);
            }
        }
    }
    check_index(recording, &counts, findings);
}

/// Checks that the index counts the messages of the file.
fn check_index(recording: &Recording, counts: &BTreeMap<String, u64>, findings: &mut Vec<String>) {
    for (name, claimed) in recording.claimed() {
        let found = counts.get(&name).copied().unwrap_or(0);
        if found != claimed {
            let what = format!("{name} has {found} messages, the index says {claimed}");
            findings.push(what);
        }
    }
    if !recording.has_chunk_index() && counts.values().sum::<u64>() > 0 {
        let what = "no chunk is indexed, so viewers find no messages";
        findings.push(what.to_owned());
    }
}
