//! The folder of a study.

use std::ffi::OsString;
use std::fs;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::files::{
    EPISODES, JOURNAL, LEARNING_CURVES, PLAN, foreign, names, read_plan, read_records, write_plan,
};
use super::journal::{self, Journal};
use super::record::{TrialRecord, trial};
use super::records::Records;
use crate::disk;
use crate::disk::{FolderLock, LOCK, LockError};
use crate::study::analysis::learning::{CurvePoint, curves};
use crate::study::error::StudyError;
use crate::study::own::Agents;
use crate::study::protocol::Protocol;
use crate::trial::Plan;

/// Maximum number of records in one write to a journal.
const MOST_AT_ONCE: usize = 1_000;
/// Files that are generated from finished trials.
const OUTPUTS: [&str; 18] = [
    "trials.csv",
    EPISODES,
    LEARNING_CURVES,
    "episodes.svg",
    "episodes.png",
    "summary.json",
    "report.md",
    "report.html",
    "first-optimal.svg",
    "first-optimal.png",
    "curves.svg",
    "curves.png",
    "steps.svg",
    "steps.png",
    "heat.svg",
    "heat.png",
    "ablation.svg",
    "ablation.png",
];

/// A folder with a frozen study and its finished trials.
#[derive(Debug)]
pub struct StudyFolder {
    path: PathBuf,
    protocol: Protocol,
    /// The id of the frozen protocol, as stored. A newer program may have more settings, and so
    /// another id.
    plan: String,
    records: Records,
    /// Whether to overwrite files whose contents differ from what the study would write.
    force: bool,
    /// Held while this process writes in the folder.
    _lock: Option<FolderLock>,
}

impl StudyFolder {
    /// Returns true if the folder contains a study.
    pub fn is_in(path: &Path) -> bool {
        path.join(PLAN).is_file()
    }

    /// Reads the folder of a study.
    ///
    /// # Errors
    /// When the folder contains no study, or a damaged one.
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let (protocol, plan) =
            read_plan(path)?.ok_or_else(|| StudyError::NoStudy(path.to_owned()))?;
        let (records, _) = read_records(path, &protocol, &plan)?;
        Ok(Self {
            path: path.to_owned(),
            protocol,
            plan,
            records,
            force: false,
            _lock: None,
        })
    }

    /// Creates a study without trials in memory. The caller adds the trials.
    pub(in crate::study) fn empty(path: &Path, protocol: &Protocol, plan: &str) -> Self {
        Self {
            path: path.to_owned(),
            protocol: protocol.clone(),
            plan: plan.to_owned(),
            records: Records::default(),
            force: false,
            _lock: None,
        }
    }

    /// Returns the trials, so that the caller can add some.
    pub(in crate::study) fn records_mut(&mut self) -> &mut Records {
        &mut self.records
    }

    /// Sets whether to overwrite files whose contents differ from what the study would write.
    pub fn replacing(self, force: bool) -> Self {
        Self { force, ..self }
    }

    /// Replaces another study in a folder by this one: removes its trials and the files generated
    /// from them, and nothing else. A folder with no study, or with this one, is left as it is.
    ///
    /// # Errors
    /// [`StudyError::Locked`], or an error of the file system.
    pub fn replace_other(path: &Path, protocol: &Protocol) -> Result<(), StudyError> {
        let is_other = read_plan(path)?.is_some_and(|(_, found)| found != protocol.id());
        if !is_other {
            return Ok(());
        }
        let _lock = lock(path)?;
        for name in OUTPUTS.into_iter().chain([JOURNAL]) {
            let file = path.join(name);
            disk::remove(&file).map_err(|cause| StudyError::io(&file, cause))?;
        }
        // The folder has a plan at any moment, so that it is recognised as the folder of a study.
        write_plan(path, protocol)
    }

    /// Writes a generated file. An existing file with other contents belongs to somebody else or
    /// was changed by hand. It is not overwritten without [`replacing`](Self::replacing).
    pub(in crate::study) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StudyError> {
        self.write_with(name, |file| file.write_all(bytes))
    }

    /// Like [`Self::write`], for contents that are written piece by piece.
    pub(in crate::study) fn write_with(
        &self,
        name: &str,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), StudyError> {
        let path = self.path.join(name);
        let written = match self.force {
            true => disk::replace_with(&path, write).map(|()| true),
            false => disk::keep_or_create(&path, write),
        };
        match written.map_err(|cause| StudyError::io(&path, cause))? {
            true => Ok(()),
            false => Err(StudyError::Exists(path)),
        }
    }

    /// Reads the folder of a study, and locks it for writing.
    ///
    /// # Errors
    /// The same as for [`Self::read`], or [`StudyError::Locked`].
    pub fn read_locked(path: &Path) -> Result<Self, StudyError> {
        // No lock file is created in a folder without a study.
        let lock = path.join(PLAN).is_file().then(|| lock(path)).transpose()?;
        let folder = Self::read(path)?;
        Ok(Self {
            _lock: lock,
            ..folder
        })
    }

    /// Merges folders of one study, in any order, in memory.
    ///
    /// # Errors
    /// [`StudyError::Mixed`] when their plans differ, [`StudyError::Contradiction`] when they
    /// disagree about a trial, or when a folder cannot be read.
    pub fn join(paths: &[PathBuf]) -> Result<Self, StudyError> {
        let mut folders = paths.iter().map(|path| Self::read(path));
        let mut joined = folders
            .next()
            .unwrap_or(Err(StudyError::NoStudy(PathBuf::new())))?;
        for folder in folders {
            joined.add(folder?)?;
        }
        Ok(joined)
    }

    /// Adds a trial of a merged study.
    fn insert(&mut self, record: &TrialRecord) -> Result<(), StudyError> {
        let inserted = self.records.insert(record);
        inserted.map_err(|_| StudyError::Contradiction {
            place: self.path.clone(),
            trial: record.trial,
            before: "the folders to be merged into it",
        })
    }

    fn add(&mut self, other: Self) -> Result<(), StudyError> {
        let (ours, theirs) = (self.plan.clone(), other.plan);
        if ours != theirs {
            return Err(StudyError::Mixed(
                self.path.clone(),
                other.path,
                ours,
                theirs,
            ));
        }
        for record in other.records.iter() {
            let trial = record.trial;
            self.records
                .insert(&record)
                .map_err(|_| StudyError::Contradiction {
                    place: other.path.clone(),
                    trial,
                    before: "the folders listed before it",
                })?;
        }
        Ok(())
    }

    /// Returns the frozen study.
    pub fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// Returns the id of the frozen study.
    pub fn plan(&self) -> &str {
        &self.plan
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the finished trials, in order.
    pub fn records(&self) -> impl Iterator<Item = TrialRecord> + Clone + '_ {
        self.records.iter()
    }

    /// Returns the finished trials in a range, in order.
    pub(in crate::study) fn records_of(
        &self,
        trials: Range<usize>,
    ) -> impl Iterator<Item = TrialRecord> + '_ {
        trials.filter_map(|trial| self.records.get(trial))
    }

    /// Returns the trials that are not finished, in order.
    pub fn missing(&self) -> Vec<usize> {
        let trials = 0..self.protocol.len();
        trials.filter(|trial| !self.records.holds(*trial)).collect()
    }

    /// Returns the failed trials, in order.
    pub fn failed(&self) -> Vec<usize> {
        let failed = self.records().filter(|record| record.result.is_err());
        failed.map(|record| record.trial).collect()
    }

    /// Returns the learning curve of each arm, as written with the episode table. `None` without a
    /// table.
    pub(in crate::study) fn learning_curves(&self) -> Option<Vec<Vec<CurvePoint>>> {
        let table = disk::read(&self.path.join(LEARNING_CURVES), disk::MOST_BYTES).ok()?;
        curves(&self.protocol.arms, self.protocol.episodes, &table)
    }

    /// Returns the best trial of a built-in method and its plan: optimal at the end, after the
    /// fewest steps, and the first of several. `None` if no such trial reached a goal.
    pub fn best_trial(&self) -> Option<(usize, Plan)> {
        let reached = self.records().filter_map(|record| {
            let progress = record.result.ok()?.progress;
            let steps = progress.first_optimal_env_steps.unwrap_or(u64::MAX);
            let is_own = self.protocol.arm(record.trial).agent.is_some();
            let progress = Some(progress).filter(|_| !is_own)?;
            Some((!progress.optimal, steps, progress.best_steps?, record.trial))
        });
        let (.., number) = reached.min()?;
        let trial = trial(&self.protocol, &Agents::default(), number).ok()?;
        Some((number, trial.plan().clone()))
    }

    /// Checks that all trials are finished.
    ///
    /// # Errors
    /// [`StudyError::Incomplete`].
    pub fn require_complete(&self) -> Result<(), StudyError> {
        let total = self.protocol.len();
        match total - self.records.len() {
            0 => Ok(()),
            missing => Err(StudyError::Incomplete { missing, total }),
        }
    }
}

/// A study folder that is locked for writing by this process.
#[derive(Debug)]
pub struct OpenFolder {
    folder: StudyFolder,
    journal: Journal,
}

impl OpenFolder {
    /// Creates or reopens the folder of a study.
    ///
    /// # Errors
    /// [`StudyError::Locked`], [`StudyError::OtherStudy`], or an error of the file system.
    pub fn open(path: &Path, protocol: &Protocol) -> Result<Self, StudyError> {
        // Check before locking, so that nothing is left in a folder of something else. If the
        // folder is locked, another process may be creating a study there.
        let held = path.join(LOCK);
        let is_free = !held.exists() || disk::is_foreign_lock(&held);
        if is_free && is_foreign(path)? {
            return Err(foreign(path));
        }
        fs::create_dir_all(path).map_err(|cause| StudyError::create(path, cause))?;
        let lock = lock(path)?;
        let wanted = protocol.id();
        match read_plan(path)? {
            None if is_foreign(path)? => return Err(foreign(path)),
            None => write_plan(path, protocol)?,
            Some((_, found)) if found == wanted => (),
            Some((_, found)) => {
                let folder = path.to_owned();
                return Err(StudyError::OtherStudy {
                    folder,
                    found,
                    wanted,
                });
            }
        }
        let (records, whole) = read_records(path, protocol, &wanted)?;
        let journal = Journal::open(&path.join(JOURNAL), &wanted, whole)?;
        let folder = StudyFolder {
            path: path.to_owned(),
            protocol: protocol.clone(),
            plan: wanted,
            records,
            force: false,
            _lock: Some(lock),
        };
        Ok(Self { folder, journal })
    }

    /// Returns the study in the folder.
    pub fn folder(&self) -> &StudyFolder {
        &self.folder
    }

    /// Stores finished trials.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn write(&mut self, records: &[TrialRecord]) -> Result<(), StudyError> {
        self.journal.write(records)?;
        let mut records = records.iter();
        records.try_for_each(|record| self.folder.insert(record))
    }

    /// Flushes the stored trials to the disk.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn sync(&mut self) -> Result<(), StudyError> {
        self.journal.sync()
    }

    /// Stores all trials of a merged study.
    ///
    /// # Errors
    /// [`StudyError::Contradiction`] when the folder has another result of a trial, or an error of
    /// the file system.
    pub fn add_all(&mut self, joined: &StudyFolder) -> Result<(), StudyError> {
        let mut missing = Vec::new();
        for record in joined.records() {
            if !self.folder.records.holds(record.trial) {
                missing.push(record);
            } else {
                self.folder.insert(&record)?;
            }
            if missing.len() == MOST_AT_ONCE {
                self.write(&std::mem::take(&mut missing))?;
            }
        }
        self.write(&missing)
    }

    /// Rewrites the journal in the order of the trials. The folder stays locked while the result
    /// lives.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn close(self) -> Result<StudyFolder, StudyError> {
        let Self { folder, journal } = self;
        drop(journal);
        let path = folder.path.join(JOURNAL);
        let written = disk::replace_with(&path, |file| {
            journal::write(file, &folder.plan, folder.records())
        });
        written.map_err(|cause| StudyError::io(&path, cause))?;
        Ok(folder)
    }
}

/// Returns true if the folder has files, but no plan of a study.
fn is_foreign(path: &Path) -> Result<bool, StudyError> {
    let names = names(path)?;
    // Files that may exist before the plan.
    let is_lock = |name: &OsString| name == LOCK && !disk::is_foreign_lock(&path.join(LOCK));
    let is_early = |name: &OsString| is_lock(name) || disk::is_leftover_of(name, PLAN);
    Ok(!names.iter().any(|name| name == PLAN) && !names.iter().all(is_early))
}

/// Locks a folder, and removes the temporary files that a killed process left in it.
fn lock(folder: &Path) -> Result<FolderLock, StudyError> {
    let lock = FolderLock::acquire(folder).map_err(|fault| match fault {
        LockError::Held(pid) => StudyError::Locked {
            folder: folder.to_owned(),
            holder: pid.map_or("another process".to_owned(), |pid| format!("process {pid}")),
        },
        LockError::File(path, cause) => StudyError::create(&path, cause),
    })?;
    let is_ours = |name: &str| [PLAN, JOURNAL].contains(&name) || OUTPUTS.contains(&name);
    let tidied = disk::remove_leftovers(folder, is_ours);
    tidied.map_err(|cause| StudyError::io(folder, cause))?;
    Ok(lock)
}
