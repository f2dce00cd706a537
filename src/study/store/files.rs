//! The files of a study: its plan and its finished trials.

use std::ffi::OsString;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::journal;
use super::records::Records;
use crate::disk;
use crate::study::error::StudyError;
use crate::study::protocol::{Protocol, id_of};

/// The frozen study.
pub const PLAN: &str = "plan.json";
/// The plan of a planned study, with the number of tasks.
pub const TASKS: &str = "tasks.json";
/// The result of a search for settings.
pub const SEARCH: &str = "search.json";
/// Finished trials.
pub const JOURNAL: &str = "journal";
/// The table of episodes.
pub const EPISODES: &str = "episodes.csv.gz";
/// The table of learning curves.
pub const LEARNING_CURVES: &str = "learning-curves.csv";

/// The contents of `plan.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanFile {
    /// The checksum of the study's text.
    plan: String,
    study: Box<RawValue>,
}

pub fn read_plan(folder: &Path) -> Result<Option<(Protocol, String)>, StudyError> {
    let path = folder.join(PLAN);
    let text = match disk::read(&path, disk::MOST_BYTES) {
        Ok(text) => text,
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(cause) => return Err(StudyError::io(&path, cause)),
    };
    let damaged = |fault: String| StudyError::damaged(&path, fault);
    let file: PlanFile =
        serde_json::from_slice(&text).map_err(|fault| damaged(fault.to_string()))?;
    let study = parse_frozen(&file.study, &file.plan).map_err(damaged)?;
    Ok(Some((study, file.plan)))
}

/// Returns the names of the files in a folder. Empty if the folder does not exist.
pub fn names(folder: &Path) -> Result<Vec<OsString>, StudyError> {
    let names = folder.read_dir().and_then(|entries| {
        let names = entries.map(|entry| Ok(entry?.file_name()));
        names.collect::<io::Result<Vec<_>>>()
    });
    match names {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        names => names.map_err(|cause| StudyError::create(folder, cause)),
    }
}

/// Returns the error for a folder with other contents, which it describes.
pub fn foreign(folder: &Path) -> StudyError {
    let kinds = [
        (PLAN, "a study created by `xcscr study run` or a merge"),
        (TASKS, "a planned study, created by `xcscr study plan`"),
        (SEARCH, "a search, created by `xcscr study tune`"),
    ];
    let found = kinds.iter().find(|(name, _)| folder.join(name).is_file());
    StudyError::Foreign {
        folder: folder.to_owned(),
        holds: found.map_or("files that xcscr did not create", |(_, what)| what),
    }
}

/// Parses a frozen study, and checks that its text has the id `plan`.
pub fn parse_frozen(study: &RawValue, plan: &str) -> Result<Protocol, String> {
    if id_of(study.get()) != plan {
        return Err("it was changed after it was frozen".to_owned());
    }
    let study: Protocol = serde_json::from_str(study.get()).map_err(|fault| fault.to_string())?;
    study.check()?;
    Ok(study)
}

/// Returns the text of a study, and its id.
pub fn frozen(protocol: &Protocol) -> (Box<RawValue>, String) {
    let text = protocol.to_json();
    let plan = id_of(&text);
    let study = RawValue::from_string(text).expect("JSON is valid JSON");
    (study, plan)
}

/// Reads the finished trials, and returns them with the number of valid bytes in the journal.
pub fn read_records(
    folder: &Path,
    protocol: &Protocol,
    plan: &str,
) -> Result<(Records, u64), StudyError> {
    let path = folder.join(JOURNAL);
    let mut checked = Records::default();
    let whole = journal::read(&path, plan, &mut |record| {
        let trial = record.trial;
        let fault = record.check(protocol);
        fault.map_err(|fault| StudyError::damaged(&path, fault))?;
        checked
            .insert(&record)
            .map_err(|_| StudyError::Contradiction {
                place: path.clone(),
                trial,
                before: "an earlier line of this file",
            })
    })?;
    Ok((checked, whole))
}

pub fn write_plan(folder: &Path, protocol: &Protocol) -> Result<(), StudyError> {
    let (study, plan) = frozen(protocol);
    write_whole(&folder.join(PLAN), &json(&PlanFile { plan, study }))
}

/// Serializes plain data as a JSON document.
pub fn json(file: &impl Serialize) -> Vec<u8> {
    let mut text = serde_json::to_string_pretty(file).expect("plain data becomes JSON");
    text.push('\n');
    text.into_bytes()
}

/// Writes a file atomically; see [`disk::replace`].
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), StudyError> {
    disk::replace(path, bytes).map_err(|cause| StudyError::io(path, cause))
}
