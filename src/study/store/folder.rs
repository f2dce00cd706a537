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

/// So many records are written to a journal at once.
const MOST_AT_ONCE: usize = 1_000;
/// What is made of finished trials.
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
    /// The protocol's id, as it was when it was frozen: a newer program may know more settings.
    plan: String,
    records: Records,
    /// May files be replaced that hold something else than the study wrote?
    force: bool,
    /// Held by who writes in the folder.
    _lock: Option<FolderLock>,
}

impl StudyFolder {
    /// Is there a study in this folder?
    pub fn is_in(path: &Path) -> bool {
        path.join(PLAN).is_file()
    }

    /// Reads the folder of a study.
    ///
    /// # Errors
    /// When there is no study in it, or a damaged one.
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

    /// A study without trials, which are yet to be gathered.
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

    /// Its trials, to be gathered.
    pub(in crate::study) fn records_mut(&mut self) -> &mut Records {
        &mut self.records
    }

    /// The same folder, in which files are replaced though they hold something else than the
    /// study wrote.
    pub fn replacing(self, force: bool) -> Self {
        Self { force, ..self }
    }

    /// Puts this study in the place of another one in a folder: removes its trials and what was made
    /// of them, and nothing else. A folder with no study, or with this one, is left as it is.
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
        // By its plan the folder is known as that of a study, at any moment.
        write_plan(path, protocol)
    }

    /// Writes something that is made of the trials. A file that holds something else is somebody
    /// else's, or was changed by hand, and stays, unless it may be [replaced](Self::replacing).
    pub(in crate::study) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StudyError> {
        self.write_with(name, |file| file.write_all(bytes))
    }

    /// The same, piece by piece.
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

    /// Reads the folder of a study in order to write in it.
    ///
    /// # Errors
    /// The same, or [`StudyError::Locked`].
    pub fn read_locked(path: &Path) -> Result<Self, StudyError> {
        // Nothing is left in a folder that is none of ours.
        let lock = path.join(PLAN).is_file().then(|| lock(path)).transpose()?;
        let folder = Self::read(path)?;
        Ok(Self {
            _lock: lock,
            ..folder
        })
    }

    /// Joins folders of one study, in any order.
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

    /// Adds a trial that was to be joined.
    fn insert(&mut self, record: &TrialRecord) -> Result<(), StudyError> {
        let inserted = self.records.insert(record);
        inserted.map_err(|_| StudyError::Contradiction {
            place: self.path.clone(),
            trial: record.trial,
            before: "the folders that are to be joined in it",
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
                    before: "the folders before it",
                })?;
        }
        Ok(())
    }

    /// The frozen study.
    pub fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// The id of the frozen study.
    pub fn plan(&self) -> &str {
        &self.plan
    }

    /// Where the folder is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The finished trials, in their order.
    pub fn records(&self) -> impl Iterator<Item = TrialRecord> + Clone + '_ {
        self.records.iter()
    }

    /// The finished ones of some trials, in their order.
    pub(in crate::study) fn records_of(
        &self,
        trials: Range<usize>,
    ) -> impl Iterator<Item = TrialRecord> + '_ {
        trials.filter_map(|trial| self.records.get(trial))
    }

    /// The trials that are not finished, in their order.
    pub fn missing(&self) -> Vec<usize> {
        let trials = 0..self.protocol.len();
        trials.filter(|trial| !self.records.holds(*trial)).collect()
    }

    /// The trials that failed.
    pub fn failed(&self) -> Vec<usize> {
        let failed = self.records().filter(|record| record.result.is_err());
        failed.map(|record| record.trial).collect()
    }

    /// By arm, the learning curve that was written with the table of episodes; `None` without one.
    pub(in crate::study) fn learning_curves(&self) -> Option<Vec<Vec<CurvePoint>>> {
        let table = disk::read(&self.path.join(LEARNING_CURVES), disk::MOST_BYTES).ok()?;
        curves(&self.protocol.arms, self.protocol.episodes, &table)
    }

    /// The best trial and its plan: optimal at the end, after the fewest steps, and of several the first. `None` if no trial of a
    /// built-in method reached a goal.
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

    /// Accepts the study when all trials are finished.
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

/// A study folder in which this process, and no other, may write.
#[derive(Debug)]
pub struct OpenFolder {
    folder: StudyFolder,
    journal: Journal,
}

impl OpenFolder {
    /// Makes or reopens the folder of a study.
    ///
    /// # Errors
    /// [`StudyError::Locked`], [`StudyError::OtherStudy`], or an error of the file system.
    pub fn open(path: &Path, protocol: &Protocol) -> Result<Self, StudyError> {
        // Without a lock yet, so that nothing is left in a folder that is none of ours. Another
        // process may be about to begin there: then it has the lock.
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

    /// What is in the folder.
    pub fn folder(&self) -> &StudyFolder {
        &self.folder
    }

    /// Keeps finished trials.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn write(&mut self, records: &[TrialRecord]) -> Result<(), StudyError> {
        self.journal.write(records)?;
        let mut records = records.iter();
        records.try_for_each(|record| self.folder.insert(record))
    }

    /// Brings them to the disk.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn sync(&mut self) -> Result<(), StudyError> {
        self.journal.sync()
    }

    /// Keeps all trials of a joined study.
    ///
    /// # Errors
    /// [`StudyError::Contradiction`] when it holds another result of one, or an error of the file
    /// system.
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

    /// Puts the journal in order. The folder stays locked as long as it is held.
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

/// Are there files, but no plan of a study?
fn is_foreign(path: &Path) -> Result<bool, StudyError> {
    let names = names(path)?;
    // What is there before the plan.
    let is_lock = |name: &OsString| name == LOCK && !disk::is_foreign_lock(&path.join(LOCK));
    let is_early = |name: &OsString| is_lock(name) || disk::is_leftover_of(name, PLAN);
    Ok(!names.iter().any(|name| name == PLAN) && !names.iter().all(is_early))
}

/// Locks a folder, and removes the temporary files of a study that a killed process left in it.
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
