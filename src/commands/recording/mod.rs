//! `xcscr recording`: inspects, checks, verifies and converts recordings.

mod check;
mod info;
mod summary;
mod verify;

use std::path::{Path, PathBuf};

use xcscr::Error;
use xcscr::run::{RunFolder, Source};

use super::failure::Failure;
use super::output::OutputFile;
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
    /// Convert a recording, or a whole run, to a bag of ROS 2: /tf, /odom, /scan, /map.
    Ros(IntoFile),
}

/// A recording or a run, and the file to write.
#[derive(Debug, clap::Args)]
pub struct IntoFile {
    /// A recording (.mcap), or the folder of a run.
    #[arg(value_name = "RECORDING|RUN")]
    from: PathBuf,
    /// The new recording (.mcap).
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Replace FILE if it exists.
    #[arg(long)]
    force: bool,
}

impl IntoFile {
    fn write(&self, make: fn(&Path) -> Result<Vec<u8>, Error>) -> Result<(), Failure> {
        let file = OutputFile::free(&self.output, self.force)?;
        file.write(&make(&self.from)?)
    }
}

/// Runs a subcommand of `recording`.
pub fn run(command: &RecordingCommand, out: &mut Results) -> Result<(), Failure> {
    match command {
        RecordingCommand::Info { recordings, json } => info::run(recordings, *json, out),
        RecordingCommand::Check(args) => check::run(args, out),
        RecordingCommand::Verify { recordings, json } => {
            verify::run(&all_recordings(recordings)?, *json, out)
        }
        RecordingCommand::Ros(args) => args.write(ros_bag),
    }
}

/// Converts an episode or a whole run for ROS 2.
fn ros_bag(from: &Path) -> Result<Vec<u8>, Error> {
    match from.is_dir() {
        true => RunFolder::open(from).ros_bag(),
        false => Source::of(from)?.ros_bag(),
    }
}
