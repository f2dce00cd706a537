//! `xcscr study status` of a planned study: its tasks.

use std::io::Write;

use serde::Serialize;
use xcscr::disk::typed;
use xcscr::study::{PlannedStudy, Slurm, TaskState};

use super::status::head;
use crate::commands::failure::Failure;

/// What became of the tasks of a study, as `study status --json` prints it.
#[derive(Debug, Serialize)]
pub(super) struct PlannedStatus {
    study: String,
    plan: String,
    trials: usize,
    finished: usize,
    /// How many trials failed; a merge shows them.
    failed_trials: usize,
    tasks: usize,
    complete: Vec<usize>,
    running: Vec<usize>,
    waiting: Vec<usize>,
    failed: Vec<usize>,
    missing: Vec<usize>,
    /// What `--array=` would complete it: the failed and missing tasks.
    array: String,
}

impl PlannedStatus {
    pub fn of(planned: &PlannedStudy) -> Result<Self, Failure> {
        let queue = match Slurm::knows(planned) {
            true => Slurm::queue(planned)?,
            false => vec![],
        };
        let survey = planned.survey()?;
        let states = survey.states(&queue);
        let tasks_that = |are: &[TaskState]| -> Vec<usize> {
            let some = states.iter().filter(|(_, state)| are.contains(state));
            some.map(|(task, _)| *task).collect()
        };
        Ok(Self {
            study: planned.protocol().name.clone(),
            plan: planned.plan().to_owned(),
            trials: survey.trials(),
            finished: survey.trials() - survey.missing().len(),
            failed_trials: survey.failed().len(),
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
        out: &mut impl Write,
    ) -> Result<(), Failure> {
        if json {
            return Ok(writeln!(out, "{}", serde_json::to_string_pretty(self)?)?);
        }
        let Self {
            study,
            plan,
            trials,
            finished,
            tasks,
            ..
        } = self;
        let head = head(study, plan, *finished, *trials);
        writeln!(out, "{head}, in {tasks} tasks")?;
        for (name, tasks) in [
            ("complete", &self.complete),
            ("running", &self.running),
            ("waiting", &self.waiting),
            ("failed: begun, and ended early", &self.failed),
            ("missing: not begun", &self.missing),
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

    /// What there is to do now.
    fn print_next(&self, planned: &PlannedStudy, out: &mut impl Write) -> std::io::Result<()> {
        let folder = typed(planned.path());
        match (&self.array[..], self.finished == self.trials) {
            (_, true) => writeln!(out, "next: xcscr study merge {folder}"),
            ("", _) => Ok(()),
            (array, _) => writeln!(
                out,
                "to complete it: --array={array}, which the same `xcscr study submit` submits again"
            ),
        }
    }
}
