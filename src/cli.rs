//! The words of the command line; the documentation here is the text of `--help`.

use clap::error::{ContextKind, ContextValue};
use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand};
use clap_complete::Shell;

use crate::commands::config::{self, ConfigArgs};
use crate::commands::drive::{self, DriveArgs};
use crate::commands::evaluate::{self, EvaluateArgs};
use crate::commands::export::{self, ExportArgs};
use crate::commands::failure::Failure;
use crate::commands::map::{self, MapArgs};
use crate::commands::recording::{self, RecordingCommand};
use crate::commands::replay::{self, ReplayArgs};
use crate::commands::results::Results;
use crate::commands::robot::{self, RobotArgs};
use crate::commands::ros_args;
use crate::commands::rules::{self, RulesArgs};
use crate::commands::simulate::{self, SimulateArgs};
use crate::commands::study::{self, StudyCommand};
use crate::commands::train::{self, TrainArgs};
use crate::commands::world::{self, WorldCommand};

const EXIT_CODES: &str = "\
Exit codes:
   0  done
   1  a condition you asked for does not hold (--require-optimal, recording
      verify, failed trials, a drive that does not reach the goal), or a study
      is unfinished
   2  wrong usage of the command line
  65  bad input data
  66  an input file is missing
  70  internal error: please report it
  73  cannot create the output
  74  input or output error, such as a full disk
  75  interrupted. Continue a run with `train --resume`, and a study with the
      same command. Nothing is kept of an interrupted `evaluate`
 130  interrupted for the second time, and ended at once";

/// A simulated robot learns rules that lead it to a goal in a maze. Every recorded episode can be
/// watched, in a browser or in Lichtblick.
///
/// Results go to stdout, everything else to stderr. NO_COLOR is honoured.
#[derive(Debug, Parser)]
#[command(version, after_long_help = EXIT_CODES, arg_required_else_help = true, max_term_width = 80)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// One variant per subcommand; its arguments live beside its code in `commands/`.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Train a robot in a maze and record every episode.
    Train(TrainArgs),
    /// Run the greedy policy of a finished run, without learning.
    Evaluate(EvaluateArgs),
    /// Drive a ROS 2 robot with a learned policy.
    Drive(DriveArgs),
    /// Simulate a ROS 2 robot in a maze.
    Simulate(SimulateArgs),
    /// Print the learned rules: the fewest that make all decisions, or all.
    Rules(RulesArgs),
    /// Write the learned policy as source code for a robot, or as a table.
    Export(ExportArgs),
    /// Open recordings in Lichtblick or Foxglove, or write a web page that plays them.
    Replay(ReplayArgs),
    /// Summarise, check and verify recordings.
    #[command(subcommand)]
    Recording(RecordingCommand),
    /// Run many trials and compare methods.
    #[command(subcommand)]
    Study(StudyCommand),
    /// Draw the learned policy over the maze.
    Map(MapArgs),
    /// Check, show, describe and generate world files.
    #[command(subcommand)]
    World(WorldCommand),
    /// Show robot profiles.
    #[command(subcommand)]
    Robot(Show<RobotArgs>),
    /// Show all settings and where each value comes from.
    #[command(subcommand)]
    Config(Show<ConfigArgs>),
    /// Print completions for a shell, such as `source <(xcscr completions bash)`.
    Completions {
        /// The shell.
        shell: Shell,
    },
}

/// A group of commands that has only `show`.
#[derive(Debug, Subcommand)]
pub enum Show<A: clap::Args> {
    Show(A),
}

impl Cli {
    /// Parses the arguments of this process.
    pub fn of_arguments() -> Result<Self, clap::Error> {
        let command = with_negative_numbers(Self::command());
        let matches = match ros_args::expanded(std::env::args_os().collect()) {
            Ok(arguments) => command.try_get_matches_from(arguments),
            Err(fault) => Err(Self::command().error(clap::error::ErrorKind::InvalidValue, fault)),
        };
        let mut matches = matches.map_err(with_places)?;
        Self::from_arg_matches_mut(&mut matches).map_err(|error| error.format(&mut Self::command()))
    }

    /// Runs the chosen subcommand; results go to `out`.
    pub fn run(self, out: &mut Results) -> Result<(), Failure> {
        match self.command {
            Command::Config(Show::Show(args)) => config::run(&args, out)?,
            Command::Completions { shell } => complete(shell, out)?,
            Command::Train(args) => train::run(&args, out)?,
            Command::Evaluate(args) => evaluate::run(&args, out)?,
            Command::Drive(args) => drive::run(&args, out)?,
            Command::Simulate(args) => simulate::run(&args)?,
            Command::Export(args) => export::run(&args, out)?,
            Command::Rules(args) => rules::run(&args, out)?,
            Command::Replay(args) => replay::run(&args, out)?,
            Command::Recording(command) => recording::run(&command, out)?,
            Command::Study(command) => study::run(&command, out)?,
            Command::Map(args) => map::run(&args)?,
            Command::World(command) => world::run(command, out)?,
            Command::Robot(Show::Show(args)) => robot::run(&args, out)?,
        }
        Ok(out.flush()?)
    }
}

/// Passes negative numbers to all options, whose own parsers say which values they accept.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let option = |arg: Arg| {
        if arg.get_long().is_some() && arg.get_action().takes_values() {
            arg.allow_negative_numbers(true)
        } else {
            arg
        }
    };
    command
        .mut_args(option)
        .mut_subcommands(with_negative_numbers)
}

/// Adds a hint to the error of an unknown subcommand, such as `check`, if one of this name exists elsewhere.
fn with_places(mut error: clap::Error) -> clap::Error {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return error;
    };
    let places = places_of(word, &Cli::command(), "xcscr");
    if !places.is_empty() {
        let tip = format!("use {}", places.join(", or "));
        error.insert(
            ContextKind::Suggested,
            ContextValue::StyledStrs(vec![tip.into()]),
        );
    }
    error
}

/// Returns the command lines below `command` that end with this subcommand.
fn places_of(word: &str, command: &clap::Command, line: &str) -> Vec<String> {
    let subcommands = command.get_subcommands().flat_map(|subcommand| {
        let name = subcommand.get_name();
        let line = format!("{line} {name}");
        let here = (name == word).then(|| format!("`{line}`"));
        here.into_iter().chain(places_of(word, subcommand, &line))
    });
    subcommands.collect()
}

/// Prints the completions for a shell.
fn complete(shell: Shell, out: &mut Results) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "xcscr", &mut text);
    Ok(out.write_all(&text)?)
}
