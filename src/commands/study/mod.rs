//! `xcscr study`: many trials, and what they say.

mod progress;
mod status;

use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;

use clap::{Subcommand, ValueEnum};
use xcscr::arena::ArenaKind;
use xcscr::study::{
    Overrides, Protocol, Report, Shard, StudyError, StudyFile, StudyFolder, merge_studies,
    run_study,
};

use crate::commands::choices;
use crate::commands::failure::{Exit, Failure};
use crate::commands::interrupt::Interrupt;
use progress::Progress;
use status::Status;

/// What to do with studies.
#[derive(Debug, Subcommand)]
pub enum StudyCommand {
    /// Run a study, or resume an interrupted one.
    Run(RunArgs),
    /// List the missing and failed trials of a study, or of its shards together.
    Status {
        /// Folders of one study.
        #[arg(required = true, value_name = "DIR")]
        folders: Vec<PathBuf>,
        /// With the study split into so many shards: list those that have trials left to run.
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
        shards: Option<u32>,
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
    /// Merge the shards of a study, in any order, into one folder.
    Merge {
        /// Folders of one study.
        #[arg(required = true, value_name = "DIR")]
        folders: Vec<PathBuf>,
        /// The folder of the whole study.
        #[arg(short, long, value_name = "DIR")]
        out: PathBuf,
        /// Replace another study in this folder, and what was changed by hand.
        #[arg(long)]
        force: bool,
    },
    /// Print the result of a study, and write report.md, report.html and the figures into its
    /// folder.
    Report {
        /// The folder of a study.
        folder: PathBuf,
        /// Replace a report and figures that hold something else, such as changes by hand.
        #[arg(long)]
        force: bool,
        /// Print the report in this format: for a terminal, as Markdown, as one HTML page that
        /// needs no other file, or as one JSON document.
        #[arg(long, value_enum, value_name = "FORMAT", default_value_t = Format::Text)]
        format: Format,
        /// The same as `--format json`.
        #[arg(long, conflicts_with = "format")]
        json: bool,
    },
}

/// How a report is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For a terminal.
    Text,
    /// Markdown.
    Md,
    /// One HTML page.
    Html,
    /// One JSON document.
    Json,
}

impl Format {
    /// JSON if `json` asks for it.
    fn or_json(self, json: bool) -> Self {
        if json { Self::Json } else { self }
    }
}

/// Arguments of `study run`.
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    /// A study file (TOML), or one of the studies that come with the program, such as paper or
    /// ablation (a name that does not exist lists them all).
    study: PathBuf,
    /// The folder of the study.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Trials of each method in each world.
    #[arg(long, value_name = "N")]
    trials: Option<usize>,
    /// Episodes of each trial.
    #[arg(long, value_name = "N")]
    episodes: Option<u32>,
    /// Root seed of all trials.
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Run in this arena instead of the study's.
    #[arg(long, value_parser = choices::arena())]
    arena: Option<ArenaKind>,
    /// Override one setting of all trials, such as `xcs.beta=0.1`.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Run only one part of several, such as 2/7.
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE)]
    shard: Shard,
    /// Trials at a time; 0 for as many as there are cores.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    jobs: u16,
    /// Replace another study in this folder, and what was changed by hand.
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of the report.
    #[arg(long)]
    json: bool,
    /// Do not show progress.
    #[arg(long)]
    quiet: bool,
}

/// Runs one of the study commands.
pub fn run(command: &StudyCommand, out: &mut impl Write) -> Result<(), Failure> {
    match command {
        StudyCommand::Run(args) => run_trials(args, out),
        StudyCommand::Status {
            folders,
            shards,
            json,
        } => {
            let folder = StudyFolder::join(folders)?;
            let status = Status::new(&folder, shards.map(|shards| shards as usize));
            status.print(*json, out)
        }
        StudyCommand::Merge {
            folders,
            out: path,
            force,
        } => {
            if *force {
                StudyFolder::replace_other(path, StudyFolder::join(folders)?.protocol())?;
            }
            let folder = merge_studies(folders, path)?.replacing(*force);
            finish(&folder, Format::Text, out)
        }
        StudyCommand::Report {
            folder,
            force,
            format,
            json,
        } => {
            let folder = StudyFolder::read_locked(folder)?.replacing(*force);
            folder.require_complete()?;
            finish(&folder, format.or_json(*json), out)
        }
    }
}

fn run_trials(args: &RunArgs, out: &mut impl Write) -> Result<(), Failure> {
    let overrides = Overrides {
        trials: args.trials,
        episodes: args.episodes,
        seed: args.seed,
        arena: args.arena,
        sets: args.set.clone(),
    };
    let protocol = Protocol::new(&StudyFile::load(&args.study)?, &overrides)?;
    say_warnings(&protocol);
    if args.force {
        StudyFolder::replace_other(&args.out, &protocol)?;
    }
    let farewell = "interrupted in a trial; run the same command again to resume it";
    let interrupt = Interrupt::watch(move || farewell.to_owned())?;
    let mut progress = Progress::new(args.quiet, interrupt.clone());
    let folder = run_study(
        &protocol,
        &args.out,
        args.shard,
        args.jobs.into(),
        &mut progress,
    )?
    .replacing(args.force);
    drop(progress);
    let missing = folder.missing();
    if missing.is_empty() {
        return finish(&folder, Format::Text.or_json(args.json), out);
    }
    if missing.iter().any(|trial| args.shard.holds(*trial)) {
        let (done, all) = (protocol.len() - missing.len(), protocol.len());
        let message = format!(
            "interrupted after {done} of {all} trials; run the same command again to resume it"
        );
        return Err(Failure::new(Exit::Interrupted, message));
    }
    Status::new(&folder, None).print(args.json, out)?;
    refuse_failed(&folder)
}

/// Says on stderr what speaks against arms of a study, once for all arms of which the same is true.
fn say_warnings(protocol: &Protocol) {
    let mut said = BTreeSet::new();
    for plan in protocol.arm_plans() {
        for warning in plan.warnings() {
            let line = format!("{}: {warning}", plan.maze.name());
            if said.insert(line.clone()) {
                eprintln!("warning: {line}");
            }
        }
    }
}

/// Writes the tables and the report of a complete study, and prints the result.
fn finish(folder: &StudyFolder, format: Format, out: &mut impl Write) -> Result<(), Failure> {
    folder.write_tables()?;
    let mut report = Report::new(folder);
    report.write(folder)?;
    match format {
        Format::Text => write!(out, "{}", report.terminal())?,
        Format::Md => write!(out, "{}", report.markdown())?,
        Format::Html => write!(out, "{}", report.html())?,
        Format::Json => writeln!(out, "{}", serde_json::to_string_pretty(&report)?)?,
    }
    refuse_failed(folder)
}

fn refuse_failed(folder: &StudyFolder) -> Result<(), Failure> {
    let mut faults = folder
        .records()
        .filter_map(|record| record.result.as_ref().err());
    let Some(first) = faults.next() else {
        return Ok(());
    };
    let (count, path) = (1 + faults.count(), folder.path().display());
    let message = format!("{count} trials failed, see {path}/trials.csv; the first: {first}");
    Err(Failure::new(Exit::Refuted, message))
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        let exit = match error {
            StudyError::Settings(error) => return error.into(),
            StudyError::World(error) => return error.into(),
            StudyError::Plan(error) => return error.into(),
            StudyError::Incomplete { .. } => Exit::Refuted,
            StudyError::Missing { .. } | StudyError::NoStudy(_) => Exit::Missing,
            StudyError::OtherStudy { .. }
            | StudyError::Foreign(_)
            | StudyError::Exists(_)
            | StudyError::Locked { .. }
            | StudyError::Create { .. } => Exit::CannotCreate,
            StudyError::Io { .. } | StudyError::Jobs { .. } => Exit::Io,
            StudyError::Figure { .. } => Exit::Internal,
            _ => Exit::BadData,
        };
        Self::new(exit, error.to_string())
    }
}
