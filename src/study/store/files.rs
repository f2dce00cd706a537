//! The plan of a study and its finished trials, as files.

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
/// The same of a study in tasks, and into how many it is split.
pub const TASKS: &str = "tasks.json";
/// What came of a search for settings.
pub const SEARCH: &str = "search.json";
/// Finished trials.
pub const JOURNAL: &str = "journal";
/// The table of episodes.
pub const EPISODES: &str = "episodes.csv.gz";
/// The table of learning curves.
pub const LEARNING_CURVES: &str = "learning-curves.csv";

/// What `plan.json` holds.
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
    let study = thawed(&file.study, &file.plan).map_err(damaged)?;
    Ok(Some((study, file.plan)))
}

/// The names of the files in a folder; none when it is not there.
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

/// Says what is in a folder that holds something else than was wanted.
pub fn foreign(folder: &Path) -> StudyError {
    let kinds = [
        (PLAN, "a study that `xcscr study run` or a merge made"),
        (TASKS, "a study in tasks, made by `xcscr study plan`"),
        (SEARCH, "a search that `xcscr study tune` made"),
    ];
    let found = kinds.iter().find(|(name, _)| folder.join(name).is_file());
    StudyError::Foreign {
        folder: folder.to_owned(),
        holds: found.map_or("files that no study wrote", |(_, what)| what),
    }
}

/// The study that was frozen as this text, if it still is the one with this id.
pub fn thawed(study: &RawValue, plan: &str) -> Result<Protocol, String> {
    if id_of(study.get()) != plan {
        return Err("it was changed after it was frozen".to_owned());
    }
    let study: Protocol = serde_json::from_str(study.get()).map_err(|fault| fault.to_string())?;
    study.check()?;
    Ok(study)
}

/// The text of a study, and its id.
pub fn frozen(protocol: &Protocol) -> (Box<RawValue>, String) {
    let text = protocol.to_json();
    let plan = id_of(&text);
    let study = RawValue::from_string(text).expect("JSON is valid JSON");
    (study, plan)
}

/// The finished trials by their numbers, and the whole bytes of their journal.
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
                before: "an earlier line of it",
            })
    })?;
    Ok((checked, whole))
}

pub fn write_plan(folder: &Path, protocol: &Protocol) -> Result<(), StudyError> {
    let (study, plan) = frozen(protocol);
    write_whole(&folder.join(PLAN), &json(&PlanFile { plan, study }))
}

/// Plain data as a JSON document.
pub fn json(file: &impl Serialize) -> Vec<u8> {
    let mut text = serde_json::to_string_pretty(file).expect("plain data becomes JSON");
    text.push('\n');
    text.into_bytes()
}

/// Writes a file so that it is there either whole or not at all; see [`disk::replace`].
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), StudyError> {
    disk::replace(path, bytes).map_err(|cause| StudyError::io(path, cause))
}
