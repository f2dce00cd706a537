//! The subcommands: thin layers over the library, one file each.

pub mod check;
mod choices;
pub mod config;
pub mod evaluate;
pub mod export;
pub mod failure;
pub mod interrupt;
mod learned;
mod live;
pub mod manual;
pub mod map;
mod progress;
pub mod recover;
pub mod replay;
pub mod rules;
mod source;
pub mod study;
pub mod terminal;
pub mod train;
mod train_report;
pub mod world;

use std::io::Write;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::cli::{Cli, Command};
use failure::Failure;

/// Runs the chosen subcommand; results go to `out`.
pub fn run(cli: Cli, out: &mut impl Write) -> Result<(), Failure> {
    match cli.command {
        Command::Config(command) => config::run(&command, out)?,
        Command::Completions { shell } => complete(shell, out)?,
        Command::Man(args) => manual::run(&args)?,
        Command::Train(args) => train::run(&args, out)?,
        Command::Evaluate(args) => evaluate::run(&args, out)?,
        Command::Export(args) => export::run(&args, out)?,
        Command::Rules(args) => rules::run(&args, out)?,
        Command::Replay(args) => replay::run(&args, out)?,
        Command::Check(args) => check::run(&args, out)?,
        Command::Study(command) => study::run(&command, out)?,
        Command::Recover(args) => recover::run(&args)?,
        Command::Map(args) => map::run(&args)?,
        Command::World(command) => world::run(command, out)?,
    }
    Ok(out.flush()?)
}

/// Prints the completions for a shell.
fn complete(shell: Shell, out: &mut impl Write) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "xcscr", &mut text);
    Ok(out.write_all(&text)?)
}
