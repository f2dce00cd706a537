//! The command line of xcscr.

#![warn(clippy::unwrap_used)]

mod cli;
mod commands;

use std::panic::catch_unwind;
use std::process::ExitCode;

use clap::error::ErrorKind as Refusal;

use cli::Cli;
use xcscr::ErrorKind;

use commands::failure::Failure;
use commands::interrupt::limits_are_errors;
use commands::results::{Results, Unwritten};

fn main() -> ExitCode {
    if let Err(failure) = limits_are_errors() {
        return failure.report();
    }
    let cli = match Cli::of_arguments() {
        Ok(cli) => cli,
        Err(refusal) => return answer(&refusal),
    };
    let run = || cli.run(&mut Results::lock());
    let outcome = catch_unwind(run).unwrap_or_else(|_| Err(Failure::internal()));
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Help is printed as it is; what is wrong with the arguments goes where all failures go, which
/// prints what they hold and never obeys it.
fn answer(refusal: &clap::Error) -> ExitCode {
    let is_help = matches!(
        refusal.kind(),
        Refusal::DisplayHelp
            | Refusal::DisplayVersion
            | Refusal::DisplayHelpOnMissingArgumentOrSubcommand
    );
    if !is_help {
        return Failure::from(refusal).report();
    }
    match refusal.print() {
        Ok(()) if refusal.use_stderr() => ExitCode::from(ErrorKind::Usage.exit_code()),
        Ok(()) => ExitCode::SUCCESS,
        Err(cause) => Failure::from(Unwritten(cause)).report(),
    }
}
