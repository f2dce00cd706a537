//! The folder of a study: its plan, and its finished trials.

use std::ops::Range;
use std::path::Path;

use super::journal;
use super::outputs::is_output;
use super::plan::{PLAN, PlannedStudy};
use super::record::{TrialRecord, trial};
use super::records::Records;
use crate::disk;
use crate::disk::{FolderLock, LOCK};
use crate::study::custom::Agents;
use crate::study::error;
use crate::study::protocol::Protocol;
use crate::trial::Plan;
use crate::{Error, ErrorKind};

/// A planned study with its finished trials.
#[derive(Debug)]
pub struct StudyFolder {
    pub(in crate::study) planned: PlannedStudy,
    pub(in crate::study) records: Records,
    /// Whether to overwrite files whose contents differ from what the study would write.
    pub(in crate::study) force: bool,
    /// Held while this process writes the results.
    _lock: Option<FolderLock>,
}

impl StudyFolder {
    /// Reads the folder of a study.
    ///
    /// # Errors
    /// When the folder contains no study, or a damaged one.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::of(PlannedStudy::read(path)?, None)
    }

    /// Reads the finished trials of a study, from all journals or from those with trials of a task.
    ///
    /// # Errors
    /// When a journal is damaged or cannot be read, or two journals disagree about a trial.
    pub fn of(planned: PlannedStudy, task: Option<usize>) -> Result<Self, Error> {
        let mut folder = Self {
            planned,
            records: Records::default(),
            force: false,
            _lock: None,
        };
        // An earlier plan has other trials in a task.
        let is_split = folder.planned.earlier().is_empty();
        for (other, path) in folder.planned.journals()? {
            if task.is_none_or(|task| task == other || !is_split) {
                folder.read_journal(&path)?;
            }
        }
        Ok(folder)
    }

    fn read_journal(&mut self, path: &Path) -> Result<(), Error> {
        let planned = self.planned.clone();
        let earlier = planned.earlier();
        let mut plans = vec![planned.plan()];
        plans.extend(earlier.iter().map(|earlier| &earlier.plan[..]));
        journal::read(path, &plans, &mut |plan, mut record| {
            let numbered = match plan {
                0 => Ok(()),
                plan => earlier[plan - 1].renumber(&mut record, planned.protocol()),
            };
            let checked = numbered.and_then(|()| record.check(planned.protocol()));
            checked.map_err(error::damaged(path))?;
            self.insert(path, &record)
        })
    }

    /// Adds a trial that was found in `place`.
    fn insert(&mut self, place: &Path, record: &TrialRecord) -> Result<(), Error> {
        match self.records.insert(record) {
            true => Ok(()),
            false => Err(ErrorKind::BadData.error(format!(
                "{} contains another result of {} than an earlier line or journal: the plan is the \
                 same, so the program or the machine may differ",
                place.display(),
                self.trial_name(record.trial)
            ))),
        }
    }

    /// Reads the folder of a study, and locks it for writing. Completes an interrupted replacement of a smaller study.
    ///
    /// # Errors
    /// The same as for [`Self::read`], or [`ErrorKind::CannotCreate`] if another process has the lock.
    pub fn read_locked(path: &Path) -> Result<Self, Error> {
        // No lock file is created in a folder without a study.
        let lock = PlannedStudy::is_in(path).then(|| lock(path)).transpose()?;
        let mut folder = Self::read(path)?;
        folder.remove_replaced()?;
        Ok(Self {
            _lock: lock,
            ..folder
        })
    }

    /// Creates or reopens the folder of a study, and locks it for writing. The folder may contain a smaller
    /// study, which stays there until the larger one is finished.
    ///
    /// # Errors
    /// When the folder is in use or contains something else, or an error of the file system.
    pub(in crate::study) fn open(path: &Path, protocol: &Protocol) -> Result<Self, Error> {
        let is_new = !PlannedStudy::is_in(path);
        if is_new || PlannedStudy::read(path)?.extended(protocol).is_none() {
            let tasks = is_new.then_some(1);
            PlannedStudy::in_folder(path, protocol.clone(), tasks)?.make()?;
        }
        let found = Self::read_locked(path)?;
        let Some(larger) = found.planned.extended(protocol) else {
            return Ok(found);
        };
        Ok(Self {
            _lock: found._lock,
            ..Self::of(larger, None)?
        })
    }

    /// Returns true if the folder still has the plan of a smaller study.
    pub(in crate::study) fn contains_smaller(&self) -> Result<bool, Error> {
        Ok(PlannedStudy::read(self.path())?.plan() != self.plan())
    }

    /// Replaces another study in a folder by this one: removes its trials and the files generated
    /// from them, and nothing else. A folder with no study, or with this one, is left as it is.
    ///
    /// # Errors
    /// When another process has the lock, or an error of the file system.
    pub fn replace_other(path: &Path, protocol: &Protocol) -> Result<(), Error> {
        if !PlannedStudy::is_in(path) {
            return Ok(());
        }
        let found = PlannedStudy::read(path)?;
        if found.plan() == protocol.id() || found.extended(protocol).is_some() {
            return Ok(());
        }
        let _lock = lock(path)?;
        let journals = found.journals()?;
        for (_, journal) in &journals {
            require_journal(journal)?;
        }
        Self::remove_outputs(path)?;
        for (_, journal) in journals {
            disk::remove(&journal).map_err(error::io(&journal))?;
        }
        // The folder has a plan at any moment, so that it is recognised as the folder of a study.
        PlannedStudy::new(path, protocol.clone(), 1)?.write(true)
    }

    /// Removes the failed trials and what was generated from them, so that the trials are run again. Their lines stay in
    /// the journals until a result replaces them.
    pub(in crate::study) fn remove_failed(&mut self) -> Result<(), Error> {
        match self.records.remove_failed() && !self.contains_smaller()? {
            true => Self::remove_outputs(self.path()),
            false => Ok(()),
        }
    }

    /// Returns the plan.
    pub fn planned(&self) -> &PlannedStudy {
        &self.planned
    }

    /// Returns the frozen study.
    pub fn protocol(&self) -> &Protocol {
        self.planned.protocol()
    }

    /// Returns the id of the frozen study.
    pub fn plan(&self) -> &str {
        self.planned.plan()
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        self.planned.path()
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
        let trials = 0..self.protocol().len();
        trials.filter(|trial| !self.records.holds(*trial)).collect()
    }

    /// Returns the trials of a task that are not finished, in order.
    pub(in crate::study) fn missing_of(&self, task: usize) -> Vec<usize> {
        let missing = self.planned.trials_of(task);
        missing
            .filter(|trial| !self.records.holds(*trial))
            .collect()
    }

    /// Returns the failed trials, in order.
    pub fn failed(&self) -> Vec<usize> {
        let failed = self.records().filter(|record| record.result.is_err());
        failed.map(|record| record.trial).collect()
    }

    /// Returns the best trial of a built-in method and its plan: optimal at the end, after the
    /// fewest steps, and the first of several. `None` if no such trial reached a goal. Repeats the trial.
    ///
    /// # Errors
    /// [`ErrorKind::BadData`] when the trial has another result than the stored one.
    pub fn best_trial(&self) -> Result<Option<(usize, Plan)>, Error> {
        let reached = self.records().filter_map(|record| {
            let progress = record.result.ok()?.progress;
            let steps = progress.first_optimal_env_steps.unwrap_or(u64::MAX);
            let is_custom = self.protocol().arm(record.trial).agent.is_some();
            let progress = Some(progress).filter(|_| !is_custom)?;
            Some((!progress.optimal, steps, progress.best_steps?, record.trial))
        });
        let Some((.., number)) = reached.min() else {
            return Ok(None);
        };
        let (protocol, agents) = (self.protocol(), Agents::default());
        self.require_equal(&TrialRecord::of(protocol, &agents, number))?;
        let trial = trial(protocol, &agents, number).ok();
        Ok(trial.map(|trial| (number, trial.plan().clone())))
    }

    /// Checks that a repeated trial has the stored result, if there is one.
    ///
    /// # Errors
    /// [`ErrorKind::BadData`] when it has another one.
    pub(in crate::study) fn require_equal(&self, repeated: &TrialRecord) -> Result<(), Error> {
        let stored = self.records.get(repeated.trial);
        if stored.is_none_or(|stored| stored.equals(repeated)) {
            return Ok(());
        }
        Err(ErrorKind::BadData.error(format!(
            "{} has another result when it is repeated than the one stored in {}: the program, the \
             machine or the agent has changed, or the agent is not deterministic; run the study again in another \
             folder (`--out`)",
            self.trial_name(repeated.trial),
            self.path().display()
        )))
    }

    /// Returns the name of a trial as in `trials.csv`: its number within its arm, and the arm.
    fn trial_name(&self, trial: usize) -> String {
        let protocol = self.protocol();
        let (number, arm) = (protocol.replicate(trial), protocol.arm(trial).name());
        format!("trial {number} of {arm}")
    }

    /// Checks that all trials are finished.
    ///
    /// # Errors
    /// [`ErrorKind::Refuted`] when they are not.
    pub fn require_complete(&self) -> Result<(), Error> {
        let total = self.protocol().len();
        match total - self.records.len() {
            0 => Ok(()),
            missing => Err(ErrorKind::Refuted.error(format!(
                "{missing} of {total} trials are missing; `xcscr study status` lists them"
            ))),
        }
    }
}

/// Checks that a file is a journal before it is removed. A user may give a file such a name.
fn require_journal(file: &Path) -> Result<(), Error> {
    match journal::is_journal(file)? {
        true => Ok(()),
        false => Err(ErrorKind::CannotCreate.error(format!(
            "{} is not a journal of xcscr; nothing was removed: move the file to another folder, then \
             run the command again",
            file.display()
        ))),
    }
}

/// Locks a folder, and removes the temporary files that a killed process left in it.
fn lock(folder: &Path) -> Result<FolderLock, Error> {
    let lock = FolderLock::acquire(folder, disk::cannot_create(&folder.join(LOCK)))?;
    let is_ours = |name: &str| name == PLAN || is_output(name);
    disk::remove_leftovers(folder, is_ours).map_err(error::io(folder))?;
    Ok(lock)
}
