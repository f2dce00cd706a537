//! The plan of a study and its finished trials, as files.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::journal::{self, Contents};
use super::record::TrialRecord;
use crate::disk;
use crate::study::error::StudyError;
use crate::study::protocol::{Protocol, id_of};

/// The frozen study.
pub const PLAN: &str = "plan.json";
/// Finished trials.
pub const JOURNAL: &str = "journal";

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
    if id_of(file.study.get()) != file.plan {
        return Err(damaged("it was changed after it was frozen".to_owned()));
    }
    let study = serde_json::from_str(file.study.get());
    let study: Protocol = study.map_err(|fault| damaged(fault.to_string()))?;
    study.check().map_err(damaged)?;
    Ok(Some((study, file.plan)))
}

/// The finished trials by their numbers, and the whole bytes of their journal.
pub fn read_records(
    folder: &Path,
    protocol: &Protocol,
    plan: &str,
) -> Result<(BTreeMap<usize, TrialRecord>, u64), StudyError> {
    let path = folder.join(JOURNAL);
    let Contents { records, whole } = journal::read(&path, plan)?;
    let mut checked = BTreeMap::new();
    for record in records {
        let trial = record.trial;
        let fault = record.check(protocol);
        fault.map_err(|fault| StudyError::damaged(&path, fault))?;
        insert(&mut checked, record).map_err(|()| StudyError::Contradiction {
            place: path.clone(),
            trial,
            before: "an earlier line of it",
        })?;
    }
    Ok((checked, whole))
}

/// Adds a record, unless another one of its trial is there.
pub fn insert(records: &mut BTreeMap<usize, TrialRecord>, record: TrialRecord) -> Result<(), ()> {
    match records.get(&record.trial) {
        Some(known) if *known != record => Err(()),
        Some(_) => Ok(()),
        None => {
            records.insert(record.trial, record);
            Ok(())
        }
    }
}

pub fn write_plan(folder: &Path, protocol: &Protocol) -> Result<(), StudyError> {
    let text = protocol.to_json();
    let file = PlanFile {
        plan: id_of(&text),
        study: RawValue::from_string(text).expect("JSON is valid JSON"),
    };
    let mut text = serde_json::to_string_pretty(&file).expect("plain data becomes JSON");
    text.push('\n');
    write_whole(&folder.join(PLAN), text.as_bytes())
}

/// Writes a file so that it is there either whole or not at all; see [`disk::replace`].
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), StudyError> {
    disk::replace(path, bytes).map_err(|cause| StudyError::io(path, cause))
}
