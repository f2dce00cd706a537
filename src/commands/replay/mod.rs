//! `xcscr replay`: what a recording shows, in words or in a viewer, and whether a new run gives
//! the same bytes.

mod serve;
mod stream;
mod verify;

use std::io::Write;
use std::path::{Path, PathBuf};

use xcscr::record::reader::Recording;

use super::failure::Failure;
use super::live::{LIVE_PORT, LiveArgs};
use super::source::recordings;

/// Arguments of `replay`.
#[derive(Debug, clap::Args)]
pub struct ReplayArgs {
    /// Recordings (.mcap), or the folder of a run.
    #[arg(required = true, value_name = "RECORDING|RUN")]
    recordings: Vec<PathBuf>,
    /// Run the trial again, and compare every recording with it bit by bit.
    #[arg(long, conflicts_with = "live")]
    verify: bool,
    /// Serve the recordings on this machine only, and print links that open them in a viewer.
    #[arg(long, conflicts_with_all = ["verify", "live"])]
    serve: bool,
    #[command(flatten)]
    live: LiveArgs,
    /// The port for `--serve` and `--live` [default: any that is free, 8765].
    #[arg(long, value_name = "P")]
    port: Option<u16>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

/// Shows, serves, streams or verifies recordings.
pub fn run(args: &ReplayArgs, out: &mut impl Write) -> Result<(), Failure> {
    let mut files = Vec::new();
    for path in &args.recordings {
        files.extend(recordings(path)?);
    }
    if let Some(broadcast) = args.live.open(args.port.unwrap_or(LIVE_PORT), 1.0)? {
        stream::run(&files, broadcast)
    } else if args.verify {
        verify::run(&files, args.json, out)
    } else if args.serve {
        serve::run(&files, args.port.unwrap_or(0), out)
    } else {
        files.iter().try_for_each(|file| show(file, out))
    }
}

fn show(file: &Path, out: &mut impl Write) -> Result<(), Failure> {
    let recording = Recording::open(file)?;
    writeln!(out, "{}", file.display())?;
    for (key, value) in recording.metadata("run").into_iter().flatten() {
        writeln!(out, "  {key:9} {value}")?;
    }
    for topic in recording.topics() {
        writeln!(
            out,
            "  {:16} {:6} {}",
            topic.name, topic.messages, topic.schema
        )?;
    }
    Ok(())
}
