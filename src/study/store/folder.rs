//! A study in its folder: its plan, and its finished trials.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::journal::{self, Journal};
use super::outputs::remove_outputs;
use super::plan::StoredPlan;
use super::record::{TrialRecord, trial};
use crate::disk::FolderLock;
use crate::study::custom::Agents;
use crate::study::protocol::Protocol;
use crate::trial::Plan;
use crate::{Error, ErrorKind};

/// A study in its folder, with its finished trials.
#[derive(Debug)]
pub struct StudyFolder {
    pub(super) path: PathBuf,
    pub(super) plan: StoredPlan,
    /// The finished trials by number.
    pub(super) records: BTreeMap<usize, TrialRecord>,
    pub(in crate::study) agents: Agents,
    /// Whether to overwrite files whose contents differ from what the study would write.
    pub(super) force: bool,
    /// Whether the folder still has the plan and the results of a smaller study.
    pub(super) grows: bool,
    /// Held while this process writes the results.
    pub(super) _lock: Option<FolderLock>,
}

impl StudyFolder {
    /// Reads the folder of a study.
    ///
    /// # Errors
    /// When the folder contains no study, or a damaged one, or two journals disagree about a trial.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::of(path, StoredPlan::read(path)?)
    }

    /// Reads the finished trials of a plan.
    pub(super) fn of(path: &Path, plan: StoredPlan) -> Result<Self, Error> {
        let mut folder = Self {
            path: path.to_owned(),
            plan,
            records: BTreeMap::new(),
            agents: Agents::default(),
            force: false,
            grows: false,
            _lock: None,
        };
        for path in journal::all(&folder.path)? {
            folder.read_journal(&path)?;
        }
        Ok(folder)
    }

    fn read_journal(&mut self, path: &Path) -> Result<(), Error> {
        let places = self.plan.arms.iter().enumerate();
        let places: BTreeMap<String, usize> = places.map(|(at, id)| (id.clone(), at)).collect();
        let trials = self.protocol().trials;
        journal::read(path, &mut |line| match places.get(&line.arm) {
            Some(arm) if (1..=trials).contains(&line.trial) => {
                let (trial, result) = (arm * trials + line.trial - 1, line.result);
                self.insert(path, TrialRecord { trial, result })
            }
            // A trial of a larger study.
            _ => Ok(()),
        })
    }

    /// Adds a record that was found in `place`. A result replaces a failure, which was repeated.
    fn insert(&mut self, place: &Path, record: TrialRecord) -> Result<(), Error> {
        match self.records.get(&record.trial).map(|known| &known.result) {
            Some(Ok(known)) if record.figures().is_some_and(|figures| figures != known) => {
                Err(ErrorKind::BadData.error(format!(
                    "{} contains another result of {} than an earlier line or journal: the plan is the \
                     same, so the program or the machine may differ",
                    place.display(),
                    self.trial_name(record.trial)
                )))
            }
            Some(Ok(_)) => Ok(()),
            _ => {
                self.records.insert(record.trial, record);
                Ok(())
            }
        }
    }

    /// Starts a new journal.
    pub(in crate::study) fn begin_journal(&self) -> Result<Journal, Error> {
        Journal::begin(&self.path, &self.plan.arms, self.protocol().trials)
    }

    /// Adds the record of a trial that was missing.
    pub(in crate::study) fn add(&mut self, record: TrialRecord) {
        self.records.insert(record.trial, record);
    }

    /// Sets the custom agents of this program, with which the protocol was frozen.
    pub fn with_agents(mut self, agents: Agents) -> Self {
        self.agents = agents;
        self
    }

    /// Sets whether to overwrite files whose contents differ from what the study would write.
    pub fn replacing(mut self, force: bool) -> Self {
        self.force = force;
        self
    }

    /// Returns the frozen study.
    pub fn protocol(&self) -> &Protocol {
        &self.plan.protocol
    }

    /// Returns the id of the frozen study.
    pub fn plan(&self) -> &str {
        &self.plan.id
    }

    /// Returns the number of tasks.
    pub fn tasks(&self) -> usize {
        self.plan.tasks
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the finished trials, in order.
    pub fn records(&self) -> impl Iterator<Item = &TrialRecord> + Clone {
        self.records.values()
    }

    /// Returns the record of a trial, if it is finished.
    pub(in crate::study) fn record(&self, trial: usize) -> Option<&TrialRecord> {
        self.records.get(&trial)
    }

    /// Returns the trials that are not finished, in order.
    pub fn missing(&self) -> Vec<usize> {
        self.missing_of(0..self.protocol().len())
    }

    fn missing_of(&self, trials: impl Iterator<Item = usize>) -> Vec<usize> {
        let is_missing = |trial: &usize| !self.records.contains_key(trial);
        trials.filter(is_missing).collect()
    }

    /// Returns the trials of a task, counted from 1, that are not finished, in order. Task `i` of `n` has every `n`-th
    /// trial. None if there is no such task.
    pub fn missing_of_task(&self, task: usize) -> Vec<usize> {
        let first = task.checked_sub(1).unwrap_or(usize::MAX);
        self.missing_of((first..self.protocol().len()).step_by(self.tasks()))
    }

    /// Returns the failed trials, in order.
    pub fn failed(&self) -> Vec<usize> {
        let failed = self.records().filter(|record| record.result.is_err());
        failed.map(|record| record.trial).collect()
    }

    /// Removes the failed trials and what was generated from them, so that the trials are run again. Their lines stay in
    /// the journals until a result replaces them.
    ///
    /// # Errors
    /// When a generated file cannot be removed.
    pub fn retry_failed(&mut self) -> Result<(), Error> {
        let all = self.records.len();
        self.records.retain(|_, record| record.result.is_ok());
        if self.records.len() < all && !self.grows {
            remove_outputs(&self.path)
        } else {
            Ok(())
        }
    }

    /// Returns the best trial of a built-in method and its plan: optimal at the end, after the
    /// fewest steps, and the first of several. `None` if no such trial reached a goal. Repeats the trial.
    ///
    /// # Errors
    /// [`ErrorKind::BadData`] when the trial has another result than the stored one.
    pub fn best_trial(&self) -> Result<Option<(usize, Plan)>, Error> {
        let reached = self.records().filter_map(|record| {
            let progress = &record.figures()?.progress;
            let steps = progress.first_optimal_env_steps.unwrap_or(u64::MAX);
            let is_custom = self.protocol().arm(record.trial).agent.is_some();
            let progress = Some(progress).filter(|_| !is_custom)?;
            Some((!progress.optimal, steps, progress.best_steps?, record.trial))
        });
        let Some((.., number)) = reached.min() else {
            return Ok(None);
        };
        let (protocol, agents) = (self.protocol(), &self.agents);
        self.require_equal(&TrialRecord::of(protocol, agents, number))?;
        let trial = trial(protocol, agents, number).ok();
        Ok(trial.map(|trial| (number, trial.plan().clone())))
    }

    /// Checks that a repeated trial has the stored result, if there is one.
    ///
    /// # Errors
    /// [`ErrorKind::BadData`] when it has another one.
    pub(in crate::study) fn require_equal(&self, repeated: &TrialRecord) -> Result<(), Error> {
        let stored = self.records.get(&repeated.trial);
        if stored.is_none_or(|stored| stored.equals(repeated)) {
            return Ok(());
        }
        Err(ErrorKind::BadData.error(format!(
            "{} has another result when it is repeated than the one stored in {}: the program, the \
             machine or the agent has changed, or the agent is not deterministic; run the study again in another \
             folder (`--out`)",
            self.trial_name(repeated.trial),
            self.path.display()
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

    /// Checks that this program made the plan. Another version may compute other results, or have other settings.
    pub(in crate::study) fn require_same_program(&self) -> Result<(), Error> {
        let (found, this) = (&self.protocol().version, env!("CARGO_PKG_VERSION"));
        if found == this {
            Ok(())
        } else {
            Err(ErrorKind::BadData.error(format!(
                "{} was planned by xcscr {found}, but this is {this}: use that version, or plan the \
                 study again in another folder",
                self.path.display()
            )))
        }
    }

    /// Checks that there is such a task, counted from 1.
    pub(in crate::study) fn require_task(&self, task: usize) -> Result<(), Error> {
        let (folder, count) = (self.path.display(), self.tasks());
        if (1..=count).contains(&task) {
            Ok(())
        } else {
            Err(ErrorKind::Usage.error(format!(
                "{folder} has no task {task}: give a number from 1 to {count}"
            )))
        }
    }
}
