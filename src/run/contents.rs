//! The files in the folder of a run, by their names.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io;
use std::path::Path;

use serde::de::IgnoredAny;

use crate::disk::{self, LOCK};
use crate::record::resume_hint::UNFINISHED;

/// The world as used by the run.
pub(super) const WORLD: &str = "world.json";
/// The settings of the run.
pub(super) const CONFIG: &str = "config.json";
/// The learned knowledge.
pub(super) const RULES: &str = "rules.json";
/// The page that plays the run.
pub(super) const PAGE: &str = "replay.html";
/// The picture of the action values at three stages of learning.
pub(super) const WORTH: &str = "worth.svg";
/// The files of recordings apart from numbered episodes.
const RECORDINGS: [&str; 4] = [
    "run.mcap",
    PAGE,
    "foxglove-layout.json",
    "foxglove-layout-run.json",
];

/// The contents of a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Contents {
    /// Nothing, or the files of a run that was killed before it began.
    Nothing,
    /// An unfinished run.
    Interrupted,
    /// A finished run.
    Run,
    /// Other files.
    Foreign,
}

impl Contents {
    /// Returns the contents of a folder, which need not exist. Files with the names of a run that
    /// no run wrote are foreign.
    pub(super) fn checked(path: &Path) -> io::Result<Self> {
        match Self::of(path)? {
            Self::Run | Self::Interrupted if !was_written_by_a_run(path)? => Ok(Self::Foreign),
            found => Ok(found),
        }
    }

    /// Returns the contents of a folder, which need not exist, by the names of the files.
    pub(super) fn of(path: &Path) -> io::Result<Self> {
        let mut names = match file_names(path) {
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(Self::Nothing),
            names => names?,
        };
        let has = |name: &str| names.iter().any(|one| one == name);
        if has(UNFINISHED) {
            return Ok(Self::Interrupted);
        }
        if has(CONFIG) {
            return Ok(Self::Run);
        }
        // Ignores the files that exist before a run begins.
        let is_lock = |name: &OsString| name == LOCK && !disk::is_foreign_lock(&path.join(LOCK));
        names.retain(|name| !is_lock(name) && !disk::is_leftover_of(name, UNFINISHED));
        Ok(if names.is_empty() {
            Self::Nothing
        } else {
            Self::Foreign
        })
    }
}

/// Returns the names of the files in a folder.
pub(super) fn file_names(path: &Path) -> io::Result<Vec<OsString>> {
    let entries = path.read_dir()?;
    entries.map(|entry| Ok(entry?.file_name())).collect()
}

/// Some fields that every version of this program writes into the `config.json` of a run.
const CONFIG_FIELDS: [&str; 5] = ["version", "method", "arena", "episodes", "settings"];
/// The fields of `unfinished.json`.
const UNFINISHED_FIELDS: [&str; 3] = ["record", "world", "config"];

/// Returns true if a run wrote the files with the names of a run. Other programs also use
/// `config.json`.
fn was_written_by_a_run(path: &Path) -> io::Result<bool> {
    use io::ErrorKind::{FileTooLarge, InvalidInput, NotFound};
    let read = |name: &str| match disk::read(&path.join(name), disk::MOST_BYTES) {
        // Files that are too large or no regular files were not written by a run.
        Err(cause) if matches!(cause.kind(), NotFound | FileTooLarge | InvalidInput) => {
            Ok(Vec::new())
        }
        bytes => bytes,
    };
    let has = |name: &str, wanted: &[&str]| -> io::Result<bool> {
        let found = serde_json::from_slice(&read(name)?);
        let found: BTreeMap<String, IgnoredAny> = found.unwrap_or_default();
        Ok(wanted.iter().all(|field| found.contains_key(*field)))
    };
    Ok(has(CONFIG, &CONFIG_FIELDS)? || has(UNFINISHED, &UNFINISHED_FIELDS)?)
}

/// Returns true if runs give this name to a file.
pub(super) fn is_of_a_run(name: &str) -> bool {
    let whole = disk::leftover_of(name).or_else(|| name.strip_suffix(".part"));
    let whole = whole.unwrap_or(name);
    let number = whole
        .strip_prefix("ep-")
        .and_then(|rest| rest.strip_suffix(".mcap"));
    let is_number = |text: &str| text.len() >= 4 && text.bytes().all(|b| b.is_ascii_digit());
    number.is_some_and(is_number)
        || [WORLD, CONFIG, RULES, WORTH, UNFINISHED].contains(&whole)
        || RECORDINGS.contains(&whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_of_run_files_are_recognised() {
        let ours =
            "ep-0001.mcap ep-123456.mcap.part .rules.json.a1B2c3.tmp run.mcap unfinished.json";
        for name in ours.split(' ') {
            assert!(is_of_a_run(name), "{name}");
        }
        let others =
            "ep-1.mcap ep-best.mcap notes.txt ep-0001.mcap.bak run ep-.mcap .notes.a1B2c3.tmp";
        for name in others.split(' ') {
            assert!(!is_of_a_run(name), "{name}");
        }
    }
}
