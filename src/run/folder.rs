//! The folder that a run leaves behind.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};

use super::error::RunFolderError;
use super::way_on::{CHECKPOINT, has_checkpoint, way_on};
use crate::agent::Knowledge;
use crate::disk::{self, FolderLock, LOCK, LockError};
use crate::record::RecordingKind;
use crate::trial::{CheckpointError, Config, Plan, is_sealed, seal, unseal};
use crate::world::Maze;

/// The world, as the run used it.
const WORLD: &str = "world.json";
/// All that was chosen.
const CONFIG: &str = "config.json";
/// What was learned.
const RULES: &str = "rules.json";
/// The page that plays the highlights.
const PAGE: &str = "replay.html";
/// What recordings leave beside numbered episodes.
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
    /// Held by whoever writes.
    _lock: Option<FolderLock>,
}

/// What a folder holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Holds {
    /// Nothing, or what a run leaves that was killed before it had begun.
    Nothing,
    /// A run with a checkpoint.
    Interrupted,
    /// A run without one.
    Run,
    /// Something else.
    Foreign,
}

impl RunFolder {
    /// The file of what was learned.
    pub(super) const RULES: &str = RULES;

    /// Is this one of the names that runs give to files?
    pub(super) fn writes(name: &str) -> bool {
        is_of_a_run(name)
    }

    /// Makes the folder of a new run, and locks it. A run that is there already is replaced only
    /// if `force` is set; then its files are removed, and nothing else.
    ///
    /// # Errors
    /// When the folder holds something, is in use, or cannot be made.
    pub fn create(path: &Path, force: bool) -> Result<Self, RunFolderError> {
        // Without a lock yet, so that nothing is left in a folder that is none of ours. Another
        // process may be about to begin there: then it has the lock.
        let lock = path.join(LOCK);
        let is_free = !lock.exists() || disk::is_foreign_lock(&lock);
        if is_free && Self::holds_ours(path)? == Holds::Foreign {
            return Err(RunFolderError::Foreign(path.to_owned()));
        }
        fs::create_dir_all(path).map_err(|cause| RunFolderError::Create {
            path: path.to_owned(),
            cause,
        })?;
        let folder = Self::locked(path)?;
        match Self::holds_ours(path)? {
            Holds::Foreign => Err(RunFolderError::Foreign(path.to_owned())),
            Holds::Interrupted if !force => Err(RunFolderError::Interrupted(path.to_owned())),
            Holds::Run if !force => Err(RunFolderError::Exists(path.to_owned())),
            Holds::Run | Holds::Interrupted => folder.clear().map(|()| folder),
            Holds::Nothing => folder.tidied(),
        }
    }

    /// Locks the folder of a run that is to go on, or that turns out to be finished.
    ///
    /// # Errors
    /// When there is no run, or another process works on it.
    pub fn resume(path: &Path) -> Result<Self, RunFolderError> {
        let found = holds(path).map_err(|cause| RunFolderError::Io {
            path: path.to_owned(),
            cause,
        })?;
        match found {
            Holds::Interrupted | Holds::Run => Self::locked(path)?.tidied(),
            _ => Err(RunFolderError::NothingToResume(path.to_owned())),
        }
    }

    /// What is in a folder; what has the names of a run, but was not written by one, is foreign.
    fn holds_ours(path: &Path) -> Result<Holds, RunFolderError> {
        let ours = holds(path).and_then(|found| match found {
            Holds::Run | Holds::Interrupted if !was_written_by_a_run(path)? => Ok(Holds::Foreign),
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

    /// Returns the names of the files in the folder, in order, but those that are no text.
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

    /// Removes the files of the run, those last by which a folder is known as that of a run.
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

    /// The folder of a run that exists, to be read.
    pub fn open(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            _lock: None,
        }
    }

    /// How to resume the run, for the end of a message; empty where its folder is gone.
    pub fn way_on(&self) -> String {
        match has_checkpoint(&self.path) {
            true => format!("; {}", way_on(&self.path)),
            false => String::new(),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Saves what the run is about to do.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_plan(&self, plan: &Plan) -> Result<(), RunFolderError> {
        let mut texts = Self::texts_of(plan).into_iter();
        texts.try_for_each(|(name, text)| self.write(name, text.as_bytes()))
    }

    /// Returns the files that hold a plan: their names, and their texts.
    pub(super) fn texts_of(plan: &Plan) -> [(&'static str, String); 2] {
        [
            (WORLD, plan.maze.to_json()),
            (CONFIG, to_json(&plan.config)),
        ]
    }

    /// The plan of the run.
    ///
    /// # Errors
    /// When a file is missing, damaged or unreadable.
    pub fn plan(&self) -> Result<Plan, RunFolderError> {
        let maze = Maze::load(&self.existing(WORLD)?)?;
        let config: Config = self.read(CONFIG)?;
        let plan = Plan { maze, config };
        plan.check().map_err(|fault| self.damaged(CONFIG, &fault))?;
        Ok(plan)
    }

    /// Saves what was learned.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_knowledge(&self, knowledge: &Knowledge) -> Result<(), RunFolderError> {
        self.write(RULES, to_json(knowledge).as_bytes())
    }

    /// What was learned.
    ///
    /// # Errors
    /// When the file is missing, damaged or unreadable.
    pub fn knowledge(&self) -> Result<Knowledge, RunFolderError> {
        self.read(RULES)
    }

    /// Saves the highlights of the run; where, and how many bytes it has.
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

    /// How to resume the run in a folder, if it was stopped.
    pub fn way_to_resume(folder: &Path) -> Option<String> {
        has_checkpoint(folder).then(|| way_on(folder))
    }

    /// Saves where the run is, in place of an earlier checkpoint.
    ///
    /// # Errors
    /// An error of the file system; the earlier checkpoint is kept.
    pub fn save_checkpoint(&self, state: &impl Serialize) -> Result<(), RunFolderError> {
        self.write(CHECKPOINT, &seal(state))
    }

    /// Does the run lack its end?
    pub fn is_interrupted(&self) -> bool {
        matches!(holds(&self.path), Ok(Holds::Interrupted))
    }

    /// Where the run was; `None` when it is finished.
    ///
    /// # Errors
    /// When the checkpoint cannot be read, or is damaged, or of another version.
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

    /// That the checkpoint is of no use, for this reason.
    pub fn bad_checkpoint(&self, fault: CheckpointError) -> RunFolderError {
        let path = self.path.join(CHECKPOINT);
        RunFolderError::Checkpoint { path, fault }
    }

    /// Ends the run: without a checkpoint it is finished.
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

/// What is in a folder, which need not exist.
fn holds(path: &Path) -> io::Result<Holds> {
    let names = path.read_dir().and_then(|entries| {
        let names = entries.map(|entry| Ok(entry?.file_name()));
        names.collect::<io::Result<Vec<_>>>()
    });
    let mut names = match names {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(Holds::Nothing),
        names => names?,
    };
    let has = |name: &str| names.iter().any(|one| one == name);
    if has(CHECKPOINT) {
        return Ok(Holds::Interrupted);
    }
    if has(CONFIG) {
        return Ok(Holds::Run);
    }
    // What is there before the first checkpoint.
    let is_lock = |name: &OsString| name == LOCK && !disk::is_foreign_lock(&path.join(LOCK));
    names.retain(|name| !is_lock(name) && !disk::is_leftover_of(name, CHECKPOINT));
    Ok(match names.is_empty() {
        true => Holds::Nothing,
        false => Holds::Foreign,
    })
}

/// What every version of this program writes into the `config.json` of a run.
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

/// Was what has the names of a run written by one? Others call their files `config.json`, too.
fn was_written_by_a_run(path: &Path) -> io::Result<bool> {
    let read = |name: &str, most| match disk::read(&path.join(name), most) {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        // It is none of ours.
        Err(cause) if cause.kind() == io::ErrorKind::FileTooLarge => Ok(Vec::new()),
        Err(cause) if cause.kind() == io::ErrorKind::InvalidInput => Ok(Vec::new()),
        bytes => bytes,
    };
    let config = read(CONFIG, disk::MOST_BYTES)?;
    Ok(serde_json::from_slice::<Signature>(&config).is_ok()
        || is_sealed(&read(CHECKPOINT, disk::MOST_BYTES)?))
}

/// Is this one of the names that runs give to files?
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

/// Is this a file that only a training leaves?
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
    fn only_names_that_runs_give_are_those_of_a_run() {
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
