//! `xcscr study`: runs studies of many trials and reports their results.

mod choice;
mod plan;
mod progress;
mod status;
mod task;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use xcscr::ErrorKind;
use xcscr::study::{Protocol, Report, StudyFolder};

use crate::commands::failure::Failure;
use crate::commands::interrupt::Interrupt;
use crate::commands::output::print_json;
use crate::commands::results::Results;
use crate::commands::terminal::{file_link, say, write_link};
use choice::ChoiceArgs;
use plan::PlanArgs;
use progress::StudyProgress;
use status::Status;
use task::TaskArgs;

/// Subcommands of `study`.
#[derive(Debug, Subcommand)]
pub enum StudyCommand {
    /// Run a study, or resume an interrupted one.
    Run(RunArgs),
    /// Show the trials of a study, and split them into tasks for many machines.
    Plan(PlanArgs),
    /// Run one task of a planned study (called by cluster jobs).
    Task(TaskArgs),
    /// List the missing and failed trials of a study, and the tasks of a planned study.
    Status {
        /// The folder of a study.
        folder: PathBuf,
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
    /// Write a row for each episode of a study into episodes.csv.gz in its folder. This repeats the
    /// trials.
    Episodes {
        /// The folder of a study.
        folder: PathBuf,
        /// Number of parallel trials; 0 for as many as there are cores.
        #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
        jobs: u16,
        /// Replace a table with different content, such as changes made by hand.
        #[arg(long)]
        force: bool,
    },
    /// Print the result of a study, and write report.md, report.html and the figures into its
    /// folder. For an unfinished study, print the table of its finished trials, without tests, and
    /// write nothing.
    Report {
        /// The folder of a study.
        folder: PathBuf,
        /// Replace a report and figures with different content, such as changes made by hand.
        #[arg(long)]
        force: bool,
        /// Print one JSON document instead of the report.
        #[arg(long)]
        json: bool,
    },
}

/// Arguments of `study run`.
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    #[command(flatten)]
    choice: ChoiceArgs,
    /// The folder of the study [default: studies/<name>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of parallel trials; 0 for as many as there are cores.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    jobs: u16,
    /// Replace another study in this folder, and changes made by hand.
    #[arg(long)]
    force: bool,
    /// Repeat the trials that failed. Replaces tables, report and figures if there are any.
    #[arg(long)]
    retry_failed: bool,
    /// Print one JSON document instead of the report.
    #[arg(long)]
    json: bool,
    /// Do not show progress.
    #[arg(long)]
    quiet: bool,
}

/// Runs a subcommand of `study`.
pub fn run(command: &StudyCommand, out: &mut Results) -> Result<(), Failure> {
    match command {
        StudyCommand::Run(args) => run_trials(args, out),
        StudyCommand::Plan(args) => plan::run(args, out),
        StudyCommand::Task(args) => task::run(args),
        StudyCommand::Status { folder, json } => {
            Status::of(&StudyFolder::read(folder)?).print(*json, out)
        }
        StudyCommand::Episodes {
            folder,
            jobs,
            force,
        } => {
            let folder = StudyFolder::read_locked(folder)?.replacing(*force);
            write_episodes(&folder, (*jobs).into())
        }
        StudyCommand::Report {
            folder,
            force,
            json,
        } => report(folder, *force, *json, out),
    }
}

fn run_trials(args: &RunArgs, out: &mut Results) -> Result<(), Failure> {
    let protocol = args.choice.protocol()?;
    say_warnings(&protocol);
    let usual = || Path::new("studies").join(&protocol.name);
    let path = args.out.clone().unwrap_or_else(usual);
    let shutdown_message = "interrupted in a trial; run the same command again to resume it";
    let interrupt =
        Interrupt::watch(move || Failure::new(ErrorKind::Interrupted, shutdown_message))?;
    let mut progress = StudyProgress::new(args.quiet, interrupt);
    let mut folder = StudyFolder::open(&path, protocol, args.force)?;
    if args.retry_failed {
        folder.retry_failed()?;
    }
    let watch = &mut |finished, trials| progress.watch(finished, trials);
    folder.run(args.jobs.into(), watch)?;
    drop(progress);
    let missing = folder.missing();
    if missing.is_empty() {
        return finish(&folder, args.json, out);
    }
    let all = folder.protocol().len();
    let done = all - missing.len();
    let message = format!(
        "interrupted after {done} of {all} trials; run the same command again to resume it"
    );
    Err(Failure::new(ErrorKind::Interrupted, message))
}

/// Writes the table of episodes of a complete study, and the report with its learning curves.
fn write_episodes(folder: &StudyFolder, jobs: usize) -> Result<(), Failure> {
    let interrupt = Interrupt::notice()?;
    let written = folder.write_episodes(jobs, &|| interrupt.came());
    if written.is_err() && interrupt.came() {
        let message = "interrupted; nothing was written: run the same command again";
        return Err(Failure::new(ErrorKind::Interrupted, message));
    }
    Ok(written?)
}

/// Prints warnings about the settings and the arms of a study on stderr, each only once.
fn say_warnings(protocol: &Protocol) {
    for (key, why) in protocol.unread() {
        say(&format!("warning: `{key}` has no effect: {why}"));
    }
    let mut said = BTreeSet::new();
    for plan in protocol.arm_plans() {
        for warning in plan.warnings() {
            let line = format!("{}: {warning}", plan.maze.name());
            if said.insert(line.clone()) {
                say(&format!("warning: {line}"));
            }
        }
    }
}

/// Reports a complete study. For an incomplete study, prints the results of its finished trials. In a folder that is
/// in use or read-only, prints the result of a complete study that has its report.
fn report(path: &Path, force: bool, is_json: bool, out: &mut Results) -> Result<(), Failure> {
    // A running study, or one in a read-only folder, can be read, but nothing can be written there.
    let (folder, busy) = match StudyFolder::read_locked(path) {
        Err(busy) if busy.kind() == ErrorKind::CannotCreate => {
            (StudyFolder::read(path)?, Some(busy))
        }
        folder => (folder?, None),
    };
    if let Err(incomplete) = folder.require_complete() {
        print_report(&Report::new(&folder), is_json, None, out)?;
        return Err(incomplete.into());
    }
    let Some(busy) = busy else {
        return finish(&folder.replacing(force), is_json, out);
    };
    if force || !path.join("report.html").is_file() {
        return Err(busy.into());
    }
    print_report(&Report::new(&folder), is_json, None, out)?;
    say(&format!("note: nothing was written: {busy}"));
    refuse_failed(&folder)
}

/// Writes the tables and the report of a complete study, and prints the result.
fn finish(folder: &StudyFolder, is_json: bool, out: &mut Results) -> Result<(), Failure> {
    let mut report = Report::new(folder);
    report.write()?;
    print_report(&report, is_json, Some(folder), out)?;
    refuse_failed(folder)
}

/// Prints a report, and its address if it was written.
fn print_report(
    report: &Report<'_>,
    is_json: bool,
    written: Option<&StudyFolder>,
    out: &mut Results,
) -> Result<(), Failure> {
    if is_json {
        return print_json(report, out);
    }
    write!(out, "{}", report.terminal())?;
    if let Some(folder) = written {
        let folder = folder.path().join("report.html");
        write!(out, "\nThe report and its figures:\n")?;
        write_link("", &file_link(&folder), out)?;
    }
    Ok(())
}

fn refuse_failed(folder: &StudyFolder) -> Result<(), Failure> {
    let mut faults = folder
        .records()
        .filter_map(|record| record.result.as_ref().err());
    let Some(first) = faults.next() else {
        return Ok(());
    };
    let (count, path) = (1 + faults.count(), folder.path().display());
    let message = format!(
        "{count} trials failed, see {path}/trials.csv; the first: {first}; `study run --retry-failed` repeats them"
    );
    Err(Failure::new(ErrorKind::Refuted, message))
}
