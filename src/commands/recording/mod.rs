//! `xcscr recording`: inspects, checks and verifies recordings.

mod check;
mod info;
mod summary;
mod verify;

use std::path::PathBuf;

use super::failure::Failure;
use super::results::Results;
use super::source::all_recordings;

/// Subcommands of `recording`.
#[derive(Debug, clap::Subcommand)]
pub enum RecordingCommand {
    /// Summarise a run, or list the contents of recordings.
    Info {
        /// Recordings (.mcap), or folders of runs.
        #[arg(required = true, value_name = "RECORDING|RUN")]
        recordings: Vec<PathBuf>,
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
    /// Check recordings for damage.
    Check(check::CheckArgs),
    /// Repeat the trial and compare every recording with it bit by bit.
    Verify {
        /// Recordings (.mcap), or folders of runs.
        #[arg(required = true, value_name = "RECORDING|RUN")]
        recordings: Vec<PathBuf>,
        /// Print one JSON document.
        #[arg(long)]
        json: bool,
    },
}

/// Runs a subcommand of `recording`.
pub fn run(command: &RecordingCommand, out: &mut Results) -> Result<(), Failure> {
    match command {
        RecordingCommand::Info { recordings, json } => info::run(recordings, *json, out),
        RecordingCommand::Check(args) => check::run(args, out),
        RecordingCommand::Verify { recordings, json } => {
            verify::run(&all_recordings(recordings)?, *json, out)
        }
    }
}
