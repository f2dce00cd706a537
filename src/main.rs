//! The command line of xcscr.

#![warn(clippy::unwrap_used)]

mod cli;
mod commands;

use std::panic::catch_unwind;
use std::process::ExitCode;

use clap::Parser;

use cli::Cli;
use commands::failure::Failure;
use commands::interrupt::limits_are_errors;
use commands::terminal::Escaping;

fn main() -> ExitCode {
    if let Err(error) = limits_are_errors() {
        return Failure::from(error).report();
    }
    let cli = Cli::parse();
    let run = || cli.run(&mut Escaping::new(std::io::stdout().lock()));
    let outcome = catch_unwind(run).unwrap_or_else(|_| Err(Failure::internal()));
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
