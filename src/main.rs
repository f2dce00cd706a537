//! The command line of xcscr.

#![warn(clippy::unwrap_used)]

mod cli;
mod commands;

use std::panic::catch_unwind;
use std::process::ExitCode;

use clap::Parser;

use cli::Cli;
use commands::failure::Failure;
use commands::interrupt::ignore_file_size_signal;

fn main() -> ExitCode {
    let cli = Cli::parse();
    if let Err(error) = ignore_file_size_signal() {
        return Failure::from(error).report();
    }
    let outcome = catch_unwind(|| commands::run(cli, &mut std::io::stdout().lock()))
        .unwrap_or_else(|_| Err(Failure::internal()));
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
