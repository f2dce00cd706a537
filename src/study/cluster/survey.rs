//! The progress of a planned study.

use super::planned::PlannedStudy;
use crate::study::error::StudyError;
use crate::study::store::Shard;

/// The progress of a planned study, or of one of its tasks.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    trials: usize,
    missing: Vec<usize>,
    failed: Vec<usize>,
    tasks: Vec<TaskSurvey>,
}

/// The progress of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TaskSurvey {
    /// Its number, from 1.
    pub task: usize,
    /// Number of missing trials.
    pub missing: usize,
    /// Number of attempts.
    pub attempts: usize,
}

impl Survey {
    /// Reads all journals, or those of one task.
    ///
    /// # Errors
    /// When a journal is damaged or cannot be read.
    pub(super) fn of(planned: &PlannedStudy, shard: Option<Shard>) -> Result<Self, StudyError> {
        let all = planned.protocol().len();
        let of_shard = |trial: &usize| shard.is_none_or(|shard| shard.holds(*trial));
        let (mut finished, mut failed) = (vec![false; all], vec![]);
        planned.each_record(shard, &mut |_, record| {
            if record.result.is_err() && !finished[record.trial] {
                failed.push(record.trial);
            }
            finished[record.trial] = true;
            Ok(())
        })?;
        failed.sort_unstable();
        let trials = (0..all).filter(of_shard);
        let missing: Vec<usize> = trials.clone().filter(|trial| !finished[*trial]).collect();
        Ok(Self {
            trials: trials.count(),
            tasks: tasks(planned, &missing)?,
            missing,
            failed,
        })
    }

    /// Returns the number of trials.
    pub fn trials(&self) -> usize {
        self.trials
    }

    /// Returns the missing trials, in order.
    pub fn missing(&self) -> &[usize] {
        &self.missing
    }

    /// Returns the failed trials, in order.
    pub fn failed(&self) -> &[usize] {
        &self.failed
    }

    /// Returns all tasks of the study, in order.
    pub fn tasks(&self) -> &[TaskSurvey] {
        &self.tasks
    }
}

impl PlannedStudy {
    /// Returns the progress of the study.
    ///
    /// # Errors
    /// When a journal is damaged or cannot be read.
    pub fn survey(&self) -> Result<Survey, StudyError> {
        Survey::of(self, None)
    }
}

fn tasks(planned: &PlannedStudy, missing: &[usize]) -> Result<Vec<TaskSurvey>, StudyError> {
    let new = |task| TaskSurvey {
        task,
        missing: 0,
        attempts: 0,
    };
    let mut tasks: Vec<TaskSurvey> = (1..=planned.tasks()).map(new).collect();
    for trial in missing {
        tasks[planned.task_of(*trial) - 1].missing += 1;
    }
    for (task, _) in planned.attempts()? {
        tasks[task - 1].attempts += 1;
    }
    Ok(tasks)
}
