//! Tasks of a planned study: running them, and their states.

use crate::study::custom::Agents;
use crate::study::runner::{StudyWatcher, run_trials};
use crate::study::store::{PlannedStudy, StudyFolder};
use crate::{Error, ErrorKind};

/// The trials of a task after an attempt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TaskProgress {
    /// Number of trials of the task.
    pub trials: usize,
    /// Number of missing trials.
    pub missing: usize,
    /// Number of trials that this attempt finished.
    pub finished: usize,
}

/// The state of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaskState {
    /// All its trials are finished.
    Complete,
    /// The task was started, and has not ended its last trial: it runs, or was interrupted.
    Started,
    /// The task was never started.
    NotStarted,
}

impl PlannedStudy {
    /// Runs the missing trials of a task, counted from 1, on `jobs` threads (all cores when 0).
    ///
    /// # Errors
    /// When there is no such task, another version of the program made the plan, or the folder
    /// cannot be read or written.
    pub fn run_task(
        &self,
        task: usize,
        jobs: usize,
        watcher: &mut dyn StudyWatcher,
    ) -> Result<TaskProgress, Error> {
        let (folder, count) = (self.path().display(), self.tasks());
        if !(1..=count).contains(&task) {
            let fault = format!("{folder} has no task {task}: give a number from 1 to {count}");
            return Err(ErrorKind::Usage.error(fault));
        }
        self.require_same_program()?;
        let mut folder = StudyFolder::of(self.clone(), Some(task))?;
        let before = folder.missing_of(task).len();
        watcher.begins(before);
        run_trials(&mut folder, &Agents::default(), task, jobs, watcher)?;
        let missing = folder.missing_of(task).len();
        Ok(TaskProgress {
            trials: self.trials_of(task).count(),
            missing,
            finished: before - missing,
        })
    }

    /// Another version may compute other results, or have other settings.
    fn require_same_program(&self) -> Result<(), Error> {
        let (found, this) = (&self.protocol().version, env!("CARGO_PKG_VERSION"));
        match found == this {
            true => Ok(()),
            false => Err(ErrorKind::BadData.error(format!(
                "{} was planned by xcscr {found}, but this is {this}: use that version, or plan the \
                 study again in another folder",
                self.path().display()
            ))),
        }
    }
}

impl StudyFolder {
    /// Returns the state of each task, counted from 1.
    ///
    /// # Errors
    /// When the folder of the journals cannot be read.
    pub fn task_states(&self) -> Result<Vec<(usize, TaskState)>, Error> {
        let tasks = self.planned().tasks();
        let (mut missing, mut attempts) = (vec![0; tasks + 1], vec![0; tasks + 1]);
        for trial in self.missing() {
            missing[trial % tasks + 1] += 1;
        }
        for (task, _) in self.planned().journals()? {
            attempts[task] += 1;
        }
        let state = |task: usize| match (missing[task], attempts[task]) {
            (0, _) => TaskState::Complete,
            (_, 0) => TaskState::NotStarted,
            _ => TaskState::Started,
        };
        Ok((1..=tasks).map(|task| (task, state(task))).collect())
    }
}
