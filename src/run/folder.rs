//! The folder of a run.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};

use super::error::RunFolderError;
use super::resume_hint::{CHECKPOINT, has_checkpoint, resume_hint};
use crate::agent::Knowledge;
use crate::disk::{self, FolderLock, LOCK, LockError};
use crate::record::RecordingKind;
use crate::trial::{CheckpointError, Config, Plan, is_sealed, seal, unseal};
use crate::world::Maze;

/// The world as used by the run.
const WORLD: &str = "world.json";
/// The settings of the run.
const CONFIG: &str = "config.json";
/// The learned knowledge.
const RULES: &str = "rules.json";
/// The page that plays the highlights.
const PAGE: &str = "replay.html";
/// The files of recordings apart from numbered episodes.
const RECORDINGS: [&str; 5] = [
    "run.mcap",
    "highlights.mcap",
    PAGE,
    "foxglove-layout.json",
    "foxglove-layout-run.json",
];

/// A folder with the files of one run: `world.json`, `config.json`, `rules.json`, recordings, and
/// a checkpoint while the run lasts.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// The lock of a folder opened for writing.
    _lock: Option<FolderLock>,
}

/// The contents of a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Contents {
    /// Nothing, or the files of a run that was killed before its first checkpoint.
    Nothing,
    /// A run with a checkpoint.
    Interrupted,
    /// A run without a checkpoint.
    Run,
    /// Other files.
    Foreign,
}

impl RunFolder {
    /// The file of the learned knowledge.
    pub(super) const RULES: &str = RULES;

    /// Returns true if runs give this name to a file.
    pub(super) fn writes(name: &str) -> bool {
        is_of_a_run(name)
    }

    /// Creates and locks the folder of a new run. An existing run is replaced only if `force` is
    /// set; then its files are removed, and nothing else.
    ///
    /// # Errors
    /// If the folder is not empty, is in use, or cannot be created.
    pub fn create(path: &Path, force: bool) -> Result<Self, RunFolderError> {
        // Checked without a lock, so that no lock file is left in a foreign folder. An existing
        // lock may belong to another process that is about to begin there.
        let lock = path.join(LOCK);
        let is_free = !lock.exists() || disk::is_foreign_lock(&lock);
        if is_free && Self::checked_contents(path)? == Contents::Foreign {
            return Err(RunFolderError::Foreign(path.to_owned()));
        }
        fs::create_dir_all(path).map_err(|cause| RunFolderError::Create {
            path: path.to_owned(),
            cause,
        })?;
        let folder = Self::locked(path)?;
        match Self::checked_contents(path)? {
            Contents::Foreign => Err(RunFolderError::Foreign(path.to_owned())),
            Contents::Interrupted if !force => Err(RunFolderError::Interrupted(path.to_owned())),
            Contents::Run if !force => Err(RunFolderError::Exists(path.to_owned())),
            Contents::Run | Contents::Interrupted => folder.clear().map(|()| folder),
            Contents::Nothing => folder.tidied(),
        }
    }

    /// Locks the folder of a run to resume it, or to find that the run is finished.
    ///
    /// # Errors
    /// If there is no run, or another process uses the folder.
    pub fn resume(path: &Path) -> Result<Self, RunFolderError> {
        let found = contents(path).map_err(|cause| RunFolderError::Io {
            path: path.to_owned(),
            cause,
        })?;
        match found {
            Contents::Interrupted | Contents::Run => Self::locked(path)?.tidied(),
            _ => Err(RunFolderError::NothingToResume(path.to_owned())),
        }
    }

    /// Returns the contents of a folder. Files with the names of a run that no run wrote are
    /// foreign.
    fn checked_contents(path: &Path) -> Result<Contents, RunFolderError> {
        let ours = contents(path).and_then(|found| match found {
            Contents::Run | Contents::Interrupted if !was_written_by_a_run(path)? => {
                Ok(Contents::Foreign)
            }
            found => Ok(found),
        });
        ours.map_err(|cause| RunFolderError::Create {
            path: path.to_owned(),
            cause,
        })
    }

    fn locked(path: &Path) -> Result<Self, RunFolderError> {
        let lock = FolderLock::acquire(path).map_err(|error| match error {
            LockError::File(path, cause) => RunFolderError::Create { path, cause },
            LockError::Held(pid) => RunFolderError::InUse {
                folder: path.to_owned(),
                pid,
            },
        })?;
        Ok(Self {
            path: path.to_owned(),
            _lock: Some(lock),
        })
    }

    /// Removes the temporary files that a killed process left.
    fn tidied(self) -> Result<Self, RunFolderError> {
        let tidied = disk::remove_leftovers(&self.path, is_of_a_run);
        tidied.map_err(|cause| RunFolderError::Io {
            path: self.path.clone(),
            cause,
        })?;
        Ok(self)
    }

    /// Returns the names of the files in the folder in order, without names that are not valid
    /// text.
    pub(super) fn names(&self) -> Result<Vec<String>, RunFolderError> {
        let entries = self.path.read_dir().and_then(Iterator::collect);
        let entries: Vec<fs::DirEntry> = entries.map_err(|cause| RunFolderError::Io {
            path: self.path.clone(),
            cause,
        })?;
        let names = entries.iter().map(fs::DirEntry::file_name);
        let mut names: Vec<String> = names.filter_map(|name| name.into_string().ok()).collect();
        names.sort_unstable();
        Ok(names)
    }

    /// Removes the files of the run; those that identify the folder as a run come last.
    fn clear(&self) -> Result<(), RunFolderError> {
        let mut names = self.names()?;
        names.retain(|name| is_of_a_run(name) && name != CONFIG && name != CHECKPOINT);
        names.extend([CHECKPOINT.to_owned(), CONFIG.to_owned()]);
        names.iter().try_for_each(|name| self.remove(name))
    }

    fn remove(&self, name: &str) -> Result<(), RunFolderError> {
        let path = self.path.join(name);
        disk::remove(&path).map_err(|cause| RunFolderError::Write { path, cause })
    }

    /// Opens the folder of an existing run for reading.
    pub fn open(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            _lock: None,
        }
    }

    /// Returns how to resume the run, for the end of a message; empty without a checkpoint.
    pub fn way_on(&self) -> String {
        match has_checkpoint(&self.path) {
            true => format!("; {}", resume_hint(&self.path)),
            false => String::new(),
        }
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Saves the plan of the run.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_plan(&self, plan: &Plan) -> Result<(), RunFolderError> {
        let mut texts = Self::texts_of(plan).into_iter();
        texts.try_for_each(|(name, text)| self.write(name, text.as_bytes()))
    }

    /// Returns the names and texts of the files of a plan.
    pub(super) fn texts_of(plan: &Plan) -> [(&'static str, String); 2] {
        [
            (WORLD, plan.maze.to_json()),
            (CONFIG, to_json(&plan.config)),
        ]
    }

    /// Returns the plan of the run.
    ///
    /// # Errors
    /// If a file is missing, damaged or unreadable.
    pub fn plan(&self) -> Result<Plan, RunFolderError> {
        let maze = Maze::load(&self.existing(WORLD)?)?;
        let config: Config = self.read(CONFIG)?;
        let plan = Plan { maze, config };
        plan.check().map_err(|fault| self.damaged(CONFIG, &fault))?;
        Ok(plan)
    }

    /// Saves the learned knowledge.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_knowledge(&self, knowledge: &Knowledge) -> Result<(), RunFolderError> {
        self.write(RULES, to_json(knowledge).as_bytes())
    }

    /// Returns the learned knowledge.
    ///
    /// # Errors
    /// If the file is missing, damaged or unreadable.
    pub fn knowledge(&self) -> Result<Knowledge, RunFolderError> {
        self.read(RULES)
    }

    /// Saves the highlights of the run. Returns the path and the size in bytes.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_highlights(&self, highlights: &[u8]) -> Result<(PathBuf, u64), RunFolderError> {
        let name = RecordingKind::Highlights.file_name();
        self.write(&name, highlights)?;
        Ok((self.path.join(name), highlights.len() as u64))
    }

    /// Saves the page that plays the highlights.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_page(&self, page: &str) -> Result<(), RunFolderError> {
        self.write(PAGE, page.as_bytes())
    }

    /// Returns the page that plays the highlights, if there is one.
    pub fn page(&self) -> Option<PathBuf> {
        let page = self.path.join(PAGE);
        page.is_file().then_some(page)
    }

    /// Returns how to resume the run in a folder, if it was stopped.
    pub fn way_to_resume(folder: &Path) -> Option<String> {
        has_checkpoint(folder).then(|| resume_hint(folder))
    }

    /// Saves a checkpoint and replaces an earlier one.
    ///
    /// # Errors
    /// An error of the file system; the earlier checkpoint is kept.
    pub fn save_checkpoint(&self, state: &impl Serialize) -> Result<(), RunFolderError> {
        self.write(CHECKPOINT, &seal(state))
    }

    /// Returns true if the run is interrupted.
    pub fn is_interrupted(&self) -> bool {
        matches!(contents(&self.path), Ok(Contents::Interrupted))
    }

    /// Returns the checkpoint; `None` if the run is finished.
    ///
    /// # Errors
    /// If the checkpoint cannot be read, is damaged, or is of another version.
    pub fn checkpoint<T: DeserializeOwned>(&self) -> Result<Option<T>, RunFolderError> {
        let path = self.path.join(CHECKPOINT);
        if !path.is_file() && self.path.join(RULES).is_file() {
            return Ok(None);
        }
        let bytes = disk::read(&path, disk::MOST_BYTES).map_err(|cause| match cause.kind() {
            io::ErrorKind::NotFound => RunFolderError::NothingToResume(self.path.clone()),
            _ => RunFolderError::Io {
                path: path.clone(),
                cause,
            },
        })?;
        let state = unseal(&bytes).map_err(|fault| self.bad_checkpoint(fault))?;
        Ok(Some(state))
    }

    /// Returns the error that the checkpoint cannot be used, with this fault.
    pub fn bad_checkpoint(&self, fault: CheckpointError) -> RunFolderError {
        let path = self.path.join(CHECKPOINT);
        RunFolderError::Checkpoint { path, fault }
    }

    /// Removes the checkpoint, which marks the run as finished.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn remove_checkpoint(&self) -> Result<(), RunFolderError> {
        self.remove(CHECKPOINT)
    }

    fn existing(&self, name: &str) -> Result<PathBuf, RunFolderError> {
        let path = self.path.join(name);
        match path.exists() {
            true => Ok(path),
            false => Err(RunFolderError::Missing(path)),
        }
    }

    fn read<T: DeserializeOwned>(&self, name: &str) -> Result<T, RunFolderError> {
        let path = self.existing(name)?;
        let text = disk::read(&path, disk::MOST_BYTES);
        let text = text.map_err(|cause| match cause.kind() {
            io::ErrorKind::FileTooLarge => self.damaged(name, &cause),
            _ => RunFolderError::Io { path, cause },
        })?;
        serde_json::from_slice(&text).map_err(|fault| self.damaged(name, &fault))
    }

    fn damaged(&self, name: &str, fault: &dyn std::fmt::Display) -> RunFolderError {
        RunFolderError::Damaged {
            path: self.path.join(name),
            fault: fault.to_string(),
        }
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), RunFolderError> {
        let path = self.path.join(name);
        disk::replace(&path, bytes).map_err(|cause| RunFolderError::Write { path, cause })
    }
}

/// Returns the contents of a folder, which need not exist.
fn contents(path: &Path) -> io::Result<Contents> {
    let names = path.read_dir().and_then(|entries| {
        let names = entries.map(|entry| Ok(entry?.file_name()));
        names.collect::<io::Result<Vec<_>>>()
    });
    let mut names = match names {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(Contents::Nothing),
        names => names?,
    };
    let has = |name: &str| names.iter().any(|one| one == name);
    if has(CHECKPOINT) {
        return Ok(Contents::Interrupted);
    }
    if has(CONFIG) {
        return Ok(Contents::Run);
    }
    // Ignores the files that exist before the first checkpoint.
    let is_lock = |name: &OsString| name == LOCK && !disk::is_foreign_lock(&path.join(LOCK));
    names.retain(|name| !is_lock(name) && !disk::is_leftover_of(name, CHECKPOINT));
    Ok(match names.is_empty() {
        true => Contents::Nothing,
        false => Contents::Foreign,
    })
}

/// The fields that every version of this program writes into the `config.json` of a run.
#[derive(Deserialize)]
struct Signature {
    #[serde(rename = "version")]
    _version: String,
    #[serde(rename = "method")]
    _method: String,
    #[serde(rename = "arena")]
    _arena: String,
    #[serde(rename = "episodes")]
    _episodes: u32,
    #[serde(rename = "settings")]
    _settings: BTreeMap<String, IgnoredAny>,
}

/// Returns true if a run wrote the files with the names of a run. Other programs also use
/// `config.json`.
fn was_written_by_a_run(path: &Path) -> io::Result<bool> {
    let read = |name: &str, most| match disk::read(&path.join(name), most) {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        // Such a file was not written by a run.
        Err(cause) if cause.kind() == io::ErrorKind::FileTooLarge => Ok(Vec::new()),
        Err(cause) if cause.kind() == io::ErrorKind::InvalidInput => Ok(Vec::new()),
        bytes => bytes,
    };
    let config = read(CONFIG, disk::MOST_BYTES)?;
    Ok(serde_json::from_slice::<Signature>(&config).is_ok()
        || is_sealed(&read(CHECKPOINT, disk::MOST_BYTES)?))
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
        || [WORLD, CONFIG, RULES, CHECKPOINT].contains(&whole)
        || RECORDINGS.contains(&whole)
        || whole == "run.mcap.again"
}

/// Returns true if only a training writes a file of this name.
pub(super) fn is_of_a_training(name: &str) -> bool {
    [WORLD, CONFIG, RULES, CHECKPOINT].contains(&name)
}

fn to_json(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string_pretty(value).expect("plain data becomes JSON");
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_of_run_files_are_recognised() {
        let ours = "ep-0001.mcap ep-123456.mcap.part .rules.json.a1B2c3.tmp run.mcap checkpoint";
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
