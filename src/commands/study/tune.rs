//! `xcscr study tune`: searches for the best settings.

use std::path::PathBuf;

use xcscr::ErrorKind;
use xcscr::disk::typed;
use xcscr::study::{Found, PlannedStudy, Rung, Stage, StudyFolder, Tuning, Verdict};

use super::choice::ChoiceArgs;
use super::progress::Progress;
use super::{Format, finish};
use crate::commands::failure::Failure;
use crate::commands::interrupt::Interrupt;
use crate::commands::results::Results;

/// Arguments of `study tune`.
#[derive(Debug, clap::Args)]
pub struct TuneArgs {
    #[command(flatten)]
    choice: ChoiceArgs,
    /// Total number of trials of the search, without the final comparison.
    #[arg(long, value_name = "N")]
    budget: usize,
    /// Folder of the search.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Split each rung into this many tasks for a cluster, and stop when there are tasks to run.
    /// Run them with `study task`, then repeat this command.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    tasks: Option<u32>,
    /// Number of parallel trials; 0 for as many as there are cores.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    jobs: u16,
    /// Do not show progress.
    #[arg(long)]
    quiet: bool,
}

/// Continues a search to its end, or until a cluster must run tasks.
pub(super) fn run(args: &TuneArgs, out: &mut Results) -> Result<(), Failure> {
    let protocol = args.choice.protocol()?;
    super::say_warnings(&protocol);
    let tasks = args.tasks.map_or(1, |tasks| tasks as usize);
    let tuning = Tuning::new(&args.out, protocol, args.budget, tasks)?;
    let shutdown_message = || Failure::new(ErrorKind::Interrupted, INTERRUPTED);
    let interrupt = Interrupt::watch(shutdown_message)?;
    loop {
        match tuning.stage()? {
            Stage::Done(found) => return show(&found, out),
            Stage::Open(planned) if args.tasks.is_some() => return Err(to_run(&planned)),
            Stage::Open(planned) => {
                let mut progress = Progress::new(args.quiet, interrupt.clone());
                let task = planned.run_task(1, args.jobs.into(), &mut progress)?;
                if task.missing > 0 {
                    return Err(shutdown_message());
                }
            }
        }
    }
}

const INTERRUPTED: &str = "the search was interrupted; run the same command again to resume it";

/// Returns the failure that names the tasks to run on a cluster.
fn to_run(planned: &PlannedStudy) -> Failure {
    let (folder, tasks) = (typed(planned.path()), planned.tasks());
    let message = format!(
        "the search waits for {}: run `xcscr study task {folder} I` with I from 1 to {tasks}, and \
         then this command again",
        planned.protocol().name
    );
    Failure::new(ErrorKind::Interrupted, message)
}

/// Prints the course of the search, and the results of the finalists on fresh seeds.
fn show(found: &Found, out: &mut Results) -> Result<(), Failure> {
    for (i, rung) in found.rungs.iter().enumerate() {
        writeln!(
            out,
            "rung {}, {} more seeds in each world",
            i + 1,
            rung.seeds
        )?;
        show_rung(rung, out)?;
    }
    let Found { budget, spent, .. } = found;
    writeln!(
        out,
        "episodes: the mean until the policy was optimal; trials in which it never was count as one \
         more than they ran. behind: difference from the best with the same seeds, with its standard error.\n\
         The search took {spent} of {budget} trials. On fresh seeds:\n"
    )?;
    let last = &found.last;
    let folder = StudyFolder::merge(&[last.path().to_owned()], &last.result())?;
    finish(&folder, Format::Text, out)
}

fn show_rung(rung: &Rung, out: &mut Results) -> Result<(), Failure> {
    for one in &rung.standings {
        let verdict = match one.verdict {
            Verdict::Stays => "stays",
            Verdict::Halved => "out: in the worse half",
            Verdict::Worse => "out: certainly worse",
        };
        writeln!(
            out,
            "  {:8.1} episodes, behind {:6.1} ± {:5.1}, {:5} trials  {verdict:20} {}",
            one.episodes, one.behind, one.behind_error, one.trials, one.candidate
        )?;
    }
    Ok(())
}
