//! `xcscr study status` for a planned study: the states of its tasks.

use serde::Serialize;
use xcscr::disk::typed;
use xcscr::study::{PlannedStudy, Slurm, StudyFolder, TaskState};

use super::status::head;
use crate::commands::failure::Failure;
use crate::commands::output::print_json;
use crate::commands::results::{Results, Unwritten};

/// The states of the tasks of a study, as `study status --json` prints them.
#[derive(Debug, Serialize)]
pub(super) struct PlannedStatus {
    study: String,
    plan: String,
    trials: usize,
    finished: usize,
    /// The number of failed trials. A merge lists them.
    failed_trials: usize,
    tasks: usize,
    complete: Vec<usize>,
    running: Vec<usize>,
    waiting: Vec<usize>,
    failed: Vec<usize>,
    missing: Vec<usize>,
    /// The value of `--array=` that completes the study: the failed and missing tasks.
    array: String,
}

impl PlannedStatus {
    pub fn of(folder: &StudyFolder) -> Result<Self, Failure> {
        let planned = folder.planned();
        let queue = match Slurm::knows(planned) {
            true => Slurm::queue(planned)?,
            false => vec![],
        };
        let (trials, states) = (planned.protocol().len(), folder.task_states(&queue)?);
        let tasks_that = |are: &[TaskState]| -> Vec<usize> {
            let some = states.iter().filter(|(_, state)| are.contains(state));
            some.map(|(task, _)| *task).collect()
        };
        Ok(Self {
            study: planned.protocol().name.clone(),
            plan: planned.plan().to_owned(),
            trials,
            finished: trials - folder.missing().len(),
            failed_trials: folder.failed().len(),
            tasks: planned.tasks(),
            complete: tasks_that(&[TaskState::Complete]),
            running: tasks_that(&[TaskState::Running]),
            waiting: tasks_that(&[TaskState::Waiting]),
            failed: tasks_that(&[TaskState::Failed]),
            missing: tasks_that(&[TaskState::Missing]),
            array: Slurm::ranges(&tasks_that(&[TaskState::Failed, TaskState::Missing])),
        })
    }

    pub fn print(
        &self,
        planned: &PlannedStudy,
        json: bool,
        out: &mut Results,
    ) -> Result<(), Failure> {
        if json {
            return print_json(self, out);
        }
        let head = head(&self.study, &self.plan, self.finished, self.trials);
        writeln!(out, "{head}, in {} tasks", self.tasks)?;
        for (name, tasks) in [
            ("complete", &self.complete),
            ("running", &self.running),
            ("waiting", &self.waiting),
            ("failed: started but ended early", &self.failed),
            ("missing: not started", &self.missing),
        ] {
            if !tasks.is_empty() {
                writeln!(out, "  {name} ({}): {}", tasks.len(), Slurm::ranges(tasks))?;
            }
        }
        if self.failed_trials > 0 {
            writeln!(out, "  trials that failed: {}", self.failed_trials)?;
        }
        Ok(self.print_next(planned, out)?)
    }

    /// Prints the next command.
    fn print_next(&self, planned: &PlannedStudy, out: &mut Results) -> Result<(), Unwritten> {
        let folder = typed(planned.path());
        match (&self.array[..], self.finished == self.trials) {
            (_, true) => writeln!(out, "next: xcscr study merge {folder}"),
            ("", _) => Ok(()),
            (array, _) => writeln!(
                out,
                "to complete it: repeat `xcscr study submit`, which submits --array={array}"
            ),
        }
    }
}
