//! The subcommands: thin layers over the library, one file each.

pub mod check;
mod choices;
pub mod evaluate;
pub mod failure;
pub mod map;
mod progress;
pub mod recover;
pub mod replay;
mod source;
pub mod train;
mod train_report;
pub mod world;

use std::io::Write;

use crate::cli::{Cli, Command};
use failure::Failure;

/// Runs the chosen subcommand; results go to `out`.
pub fn run(cli: Cli, out: &mut impl Write) -> Result<(), Failure> {
    match cli.command {
        Command::Train(args) => train::run(&args, out)?,
        Command::Evaluate(args) => evaluate::run(&args, out)?,
        Command::Replay(args) => replay::run(&args, out)?,
        Command::Check(args) => check::run(&args, out)?,
        Command::Recover(args) => recover::run(&args)?,
        Command::Map(args) => map::run(&args)?,
        Command::World(command) => world::run(command, out)?,
    }
    Ok(out.flush()?)
}
