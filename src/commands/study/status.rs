//! `xcscr study status`: lists missing and failed trials, and the tasks to run.

use serde::Serialize;
use xcscr::disk::typed;
use xcscr::study::{Arm, StudyFolder};

use crate::commands::failure::Failure;
use crate::commands::output::print_json;
use crate::commands::results::{Results, Unwritten};

/// The most arms with all trials listed that get a line each.
const MANY_ARMS: usize = 8;

/// The status of a study, as `study status --json` prints it.
#[derive(Debug, Serialize)]
pub(super) struct Status {
    study: String,
    plan: String,
    trials: usize,
    finished: usize,
    failed: Vec<usize>,
    missing: Vec<usize>,
    /// The names of the arms, and the number of trials in each.
    #[serde(skip)]
    arms: (Vec<String>, usize),
    /// The tasks of a study that is split into several.
    #[serde(flatten)]
    tasks: Option<Tasks>,
}

/// The tasks of a study.
#[derive(Debug, Serialize)]
struct Tasks {
    tasks: usize,
    /// The tasks with missing trials.
    open: Vec<usize>,
    /// The list of the tasks to run, in the form of Slurm's `--array=`.
    array: String,
    #[serde(skip)]
    folder: String,
}

impl Status {
    pub fn of(folder: &StudyFolder) -> Self {
        let (protocol, missing) = (folder.protocol(), folder.missing());
        Self {
            study: protocol.name.clone(),
            plan: folder.plan().to_owned(),
            trials: protocol.len(),
            finished: protocol.len() - missing.len(),
            failed: folder.failed(),
            arms: (
                protocol.arms.iter().map(Arm::name).collect(),
                protocol.trials,
            ),
            missing,
            tasks: (folder.tasks() > 1).then(|| Tasks::of(folder)),
        }
    }

    pub fn print(&self, json: bool, out: &mut Results) -> Result<(), Failure> {
        if json {
            return print_json(self, out);
        }
        let (study, plan, finished, trials) = (&self.study, &self.plan, self.finished, self.trials);
        writeln!(
            out,
            "study {study}, plan {plan}: {finished} of {trials} trials finished"
        )?;
        for (name, trials) in [("missing", &self.missing), ("failed", &self.failed)] {
            if !trials.is_empty() {
                writeln!(out, "  {name} ({}):", trials.len())?;
            }
            for line in self.listed(trials) {
                writeln!(out, "    {line}")?;
            }
        }
        if let Some(tasks) = &self.tasks {
            tasks.print(out)?;
        }
        Ok(())
    }

    /// Lists trials, numbered as in trials.csv, with one line for each arm. If there are many arms
    /// of which every trial is listed, they share one line.
    fn listed(&self, trials: &[usize]) -> Vec<String> {
        let (names, per_arm) = &self.arms;
        let arms = trials.chunk_by(|a, b| a / per_arm == b / per_arm);
        let (whole, part): (Vec<_>, Vec<_>) = arms.partition(|own| own.len() == *per_arm);
        let line = |own: &&[usize]| {
            let numbers: Vec<usize> = own.iter().map(|trial| trial % per_arm + 1).collect();
            let numbers = ranges(&numbers).replace(',', " ");
            format!("{}: {numbers}", names[own[0] / per_arm])
        };
        let mut lines: Vec<String> = part.iter().map(line).collect();
        match whole.len() {
            0..=MANY_ARMS => lines.extend(whole.iter().map(line)),
            many => lines.push(format!("all {per_arm} trials of each of {many} arms")),
        }
        lines
    }
}

impl Tasks {
    fn of(folder: &StudyFolder) -> Self {
        let is_open = |task: &usize| !folder.missing_of_task(*task).is_empty();
        let open: Vec<usize> = (1..=folder.tasks()).filter(is_open).collect();
        Self {
            tasks: folder.tasks(),
            array: ranges(&open),
            open,
            folder: typed(folder.path()),
        }
    }

    /// Prints the tasks, and the next step.
    fn print(&self, out: &mut Results) -> Result<(), Unwritten> {
        let (tasks, open) = (self.tasks, self.open.len());
        writeln!(out, "{tasks} tasks, {open} of them with missing trials")?;
        match &self.array[..] {
            "" => writeln!(out, "next: xcscr study report {}", self.folder),
            array => writeln!(
                out,
                "to complete it, run the tasks that do not run now, in Slurm with --array={array}"
            ),
        }
    }
}

/// Formats ascending numbers as ranges, such as `1-3,7`.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let run = |run: &[usize]| match run {
        [first, .., last] => format!("{first}-{last}"),
        _ => run.iter().map(usize::to_string).collect(),
    };
    runs.map(run).collect::<Vec<_>>().join(",")
}
