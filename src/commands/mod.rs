//! The subcommands: thin layers over the library, one file each.

pub mod failure;
pub mod world;

use std::io::Write;

use crate::cli::{Cli, Command};
use failure::Failure;

/// Runs the chosen subcommand; results go to `out`.
pub fn run(cli: Cli, out: &mut impl Write) -> Result<(), Failure> {
    match cli.command {
        Command::World(command) => world::run(command, out)?,
    }
    Ok(out.flush()?)
}
