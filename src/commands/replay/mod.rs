//! `xcscr replay`: opens recordings in a viewer.

pub mod browser;
mod highlights;
mod page;
mod serve;
mod stream;
mod terminal;

use std::path::PathBuf;

use xcscr::ErrorKind;
use xcscr::record::Comparison;

use super::failure::Failure;
use super::live::{LIVE_PORT, LiveArgs};
use super::output::OutputFile;
use super::results::Results;
use super::source::all_recordings;

/// Arguments of `replay`.
#[derive(Debug, clap::Args)]
pub struct ReplayArgs {
    /// Recordings (.mcap), or the folder of a run. `--html` takes the folder of a study, too.
    #[arg(required = true, value_name = "RECORDING|RUN")]
    recordings: Vec<PathBuf>,
    /// Show the highlights of two runs side by side.
    #[arg(long, conflicts_with = "live")]
    compare: bool,
    /// Write a web page that plays the recording without network, server or viewer. For a run, the
    /// page shows the highlights and the episodes; for a study, those of its best trial; with
    /// `--compare`, the highlights of two runs side by side.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["live", "output"])]
    html: Option<PathBuf>,
    /// Play the recording in this terminal: the maze, the robot, and each decision in words. For a
    /// run, play the highlights. If the output is a file or a pipe, write every decision.
    #[arg(long, conflicts_with_all = ["live", "compare", "html", "open"])]
    terminal: bool,
    /// Write the comparison to this file (.mcap) instead of serving it.
    #[arg(short, long, value_name = "FILE", requires = "compare")]
    output: Option<PathBuf>,
    /// Replace the file of `--html` or `--output` if it exists.
    #[arg(long)]
    force: bool,
    /// Open the first link, or the page, in the browser.
    #[arg(long, conflicts_with_all = ["live", "output"])]
    open: bool,
    #[command(flatten)]
    live: LiveArgs,
    /// Port [default: any free one; with `--live` 8765].
    #[arg(long, value_name = "P")]
    port: Option<u16>,
}

/// Streams recordings, or serves them on this machine only and prints links that open them.
pub fn run(args: &ReplayArgs, out: &mut Results) -> Result<(), Failure> {
    if args.terminal {
        return terminal::run(&args.recordings, out);
    }
    if let Some(file) = &args.html {
        let output = (file.as_path(), args.force);
        return page::write(&args.recordings, args.compare, output, args.open, out);
    }
    if args.compare {
        return compare(args, out);
    }
    let files = all_recordings(&args.recordings)?;
    if let Some(broadcast) = args.live.open(args.port.unwrap_or(LIVE_PORT), 1.0)? {
        return stream::run(&files, broadcast);
    }
    let shown = highlights::write_missing(&args.recordings, files)?;
    serve::run(serve::offers(&shown.files)?, &args.service(), out)
}

impl ReplayArgs {
    fn service(&self) -> serve::Service<'_> {
        serve::Service {
            port: self.port.unwrap_or(0),
            origins: &self.live.allow_origin,
            open: self.open,
        }
    }
}

/// Compares two runs side by side, in a file or in a viewer.
fn compare(args: &ReplayArgs, out: &mut Results) -> Result<(), Failure> {
    let [a, b] = &args.recordings[..] else {
        let message = "`--compare` takes two runs".to_owned();
        return Err(Failure::new(ErrorKind::Usage, message));
    };
    if let Some(output) = &args.output {
        let file = OutputFile::free(output, args.force)?;
        return file.write(&Comparison::of([a, b])?.bytes);
    }
    let comparison = Comparison::of([a, b])?;
    let unwritten = &Failure::system("write a temporary file");
    let folder = tempfile::tempdir().map_err(unwritten)?;
    let file = folder.path().join("comparison.mcap");
    std::fs::write(&file, &comparison.bytes).map_err(unwritten)?;
    let [of_a, of_b] = &comparison.headings;
    let offer = serve::Offer {
        what: format!("A: {of_a}\nB: {of_b}"),
        layout: comparison.layout,
        files: vec![file],
        left_out: 0,
    };
    serve::run(vec![offer], &args.service(), out)
}
