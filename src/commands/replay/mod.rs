//! `xcscr replay`: opens recordings in a viewer.

mod highlights;
mod page;
mod serve;

use std::path::PathBuf;

use xcscr::ErrorKind;
use xcscr::record::Comparison;
use xcscr::record::server::Origin;

use super::failure::Failure;
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
    #[arg(long)]
    compare: bool,
    /// Write a web page that plays the recording without network, server or viewer. For a run, the
    /// page shows the highlights and the episodes; for a study, those of its best trial; with
    /// `--compare`, the highlights of two runs side by side.
    #[arg(long, value_name = "FILE", conflicts_with = "output")]
    html: Option<PathBuf>,
    /// Write the comparison to this file (.mcap) instead of serving it.
    #[arg(short, long, value_name = "FILE", requires = "compare")]
    output: Option<PathBuf>,
    /// Replace the file of `--html` or `--output` if it exists.
    #[arg(long)]
    force: bool,
    /// Also let pages of this origin read the recordings, such as https://viewer.example.
    #[arg(long, value_name = "ORIGIN")]
    allow_origin: Vec<Origin>,
    /// Port [default: any free one].
    #[arg(long, value_name = "P", default_value_t = 0, hide_default_value = true)]
    port: u16,
}

/// Writes a page, or serves recordings on this machine only and prints links that open them.
pub fn run(args: &ReplayArgs, out: &mut Results) -> Result<(), Failure> {
    if let Some(file) = &args.html {
        let output = (file.as_path(), args.force);
        return page::write(&args.recordings, args.compare, output, out);
    }
    if args.compare {
        return compare(args, out);
    }
    let files = all_recordings(&args.recordings)?;
    let shown = highlights::write_missing(&args.recordings, files)?;
    serve::run(serve::offers(&shown.files)?, &args.service(), out)
}

impl ReplayArgs {
    fn service(&self) -> serve::Service<'_> {
        serve::Service {
            port: self.port,
            origins: &self.allow_origin,
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
