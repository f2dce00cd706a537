//! `xcscr study plan`: shows the trials of a study.

use std::path::{Path, PathBuf};

use serde::Serialize;
use xcscr::disk::typed;
use xcscr::study::{Arm, Protocol, StudyFolder};

use super::choice::ChoiceArgs;
use crate::commands::failure::Failure;
use crate::commands::output::print_json;
use crate::commands::results::{Results, Unwritten};
use crate::commands::terminal::say;

/// Arguments of `study plan`.
#[derive(Debug, clap::Args)]
pub struct PlanArgs {
    #[command(flatten)]
    choice: ChoiceArgs,
    /// Number of tasks to split the study into, each one cluster job.
    #[arg(long, value_name = "N")]
    tasks: Option<usize>,
    /// Save the plan of the study in this folder for `study task`, and print an array job
    /// for Slurm.
    #[arg(long, value_name = "DIR", requires = "tasks")]
    out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// The outline of a study, as `study plan --json` prints it.
#[derive(Debug, Serialize)]
struct Outline {
    study: String,
    plan: String,
    arms: Vec<String>,
    trials_per_arm: usize,
    trials: usize,
    episodes: u32,
    seed: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    tasks: Option<usize>,
}

/// Prints the outline of a study, and freezes the study if there is a folder for it.
pub(super) fn run(args: &PlanArgs, out: &mut Results) -> Result<(), Failure> {
    let protocol = args.choice.protocol()?;
    super::say_warnings(&protocol);
    let outline = Outline::of(&protocol, args.tasks);
    let tasks = args.tasks.unwrap_or(1);
    protocol.check_tasks(tasks)?;
    match &args.out {
        Some(folder) => drop(StudyFolder::plan_tasks(folder, protocol, tasks)?),
        None if args.json => {}
        None => {
            say("nothing was written: use `--tasks` and `--out` to freeze the study in a folder");
        }
    }
    if args.json {
        return print_json(&outline, out);
    }
    outline.print(out)?;
    if let (Some(folder), Some(tasks)) = (&args.out, args.tasks) {
        write!(out, "\n{}", array_job(folder, tasks))?;
    }
    Ok(())
}

/// Returns a script that runs every task of a planned study in Slurm.
fn array_job(folder: &Path, tasks: usize) -> String {
    let script = include_str!("array.sh").replace("@TASKS@", &tasks.to_string());
    format!("#!/bin/sh\n{}", script.replace("@FOLDER@", &typed(folder)))
}

impl Outline {
    fn of(protocol: &Protocol, tasks: Option<usize>) -> Self {
        Self {
            study: protocol.name.clone(),
            plan: protocol.id(),
            arms: protocol.arms.iter().map(Arm::name).collect(),
            trials_per_arm: protocol.trials,
            trials: protocol.len(),
            episodes: protocol.episodes,
            seed: protocol.seed,
            tasks,
        }
    }

    fn print(&self, out: &mut Results) -> Result<(), Unwritten> {
        let (study, plan, trials) = (&self.study, &self.plan, self.trials);
        writeln!(out, "study {study}, plan {plan}, root seed {}", self.seed)?;
        for arm in &self.arms {
            writeln!(out, "  {arm}")?;
        }
        let (per_arm, episodes) = (self.trials_per_arm, self.episodes);
        writeln!(
            out,
            "{} arms x {per_arm} trials of {episodes} episodes = {trials} trials",
            self.arms.len()
        )?;
        if let Some(tasks) = self.tasks {
            let most = trials.div_ceil(tasks);
            writeln!(out, "{tasks} tasks of at most {most} trials")?;
        }
        Ok(())
    }
}
