//! Tasks of a planned study: running them, and their states.

use super::slurm::Queued;
use crate::error::{Error, ErrorKind};
use crate::study::own::Agents;
use crate::study::runner::{StudyWatcher, run_trials};
use crate::study::store::plan::ALL_TASKS;
use crate::study::store::{PlannedStudy, Shard, StudyFolder};

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
    /// The task is running.
    Running,
    /// The task is in the queue.
    Waiting,
    /// The task was started, and ended before its last trial.
    Failed,
    /// The task was never started.
    Missing,
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
        let fault = || format!("{folder} has no task {task}: give a number from 1 to {count}");
        let shard = Shard::nth(task, count).ok_or_else(|| ErrorKind::Usage.error(fault()))?;
        self.require_same_program()?;
        let mut folder = StudyFolder::of(self.clone(), Some(task))?;
        let missing = |folder: &StudyFolder| {
            let mut missing = folder.missing();
            missing.retain(|trial| shard.holds(*trial));
            missing
        };
        let before = missing(&folder);
        let agents = Agents::default();
        run_trials(&mut folder, &agents, (task, &before), jobs, watcher)?;
        let after = missing(&folder).len();
        let trials = 0..self.protocol().len();
        Ok(TaskProgress {
            trials: trials.filter(|trial| shard.holds(*trial)).count(),
            missing: after,
            finished: before.len() - after,
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
    /// Returns the state of each task, counted from 1, given the tasks in the queue.
    ///
    /// # Errors
    /// When the folder of the journals cannot be read.
    pub fn task_states(&self, queue: &[Queued]) -> Result<Vec<(usize, TaskState)>, Error> {
        let tasks = self.planned().tasks();
        let (mut missing, mut attempts) = (vec![0; tasks + 1], vec![0; tasks + 1]);
        for trial in self.missing() {
            missing[trial % tasks + 1] += 1;
        }
        for (task, _) in self.planned().journals()? {
            attempts[task] += 1;
        }
        let state = |task: usize| {
            let queued = queue.iter().find(|waiting| waiting.task == task);
            match (missing[task], queued, attempts[task] + attempts[ALL_TASKS]) {
                (0, _, _) => TaskState::Complete,
                (_, Some(Queued { running: true, .. }), _) => TaskState::Running,
                (_, Some(_), _) => TaskState::Waiting,
                (_, None, 0) => TaskState::Missing,
                (_, None, _) => TaskState::Failed,
            }
        };
        Ok((1..=tasks).map(|task| (task, state(task))).collect())
    }
}
