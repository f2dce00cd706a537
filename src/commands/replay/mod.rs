//! `xcscr replay`: opens recordings in a viewer.

mod page;
mod serve;

use std::path::PathBuf;

use xcscr::replay::server::Origin;

use super::failure::Failure;
use super::results::Results;
use super::source::all_recordings;

/// Arguments of `replay`.
#[derive(Debug, clap::Args)]
pub struct ReplayArgs {
    /// Recordings (.mcap), or the folder of a run. `--html` takes the folder of a study, too.
    #[arg(required = true, value_name = "RECORDING|RUN")]
    recordings: Vec<PathBuf>,
    /// Write a web page that plays the recording without network, server or viewer. For a run, it
    /// plays the learned policy and the episodes; for a study, those of its best trial.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Replace the file of `--html` if it exists.
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
        return page::write(&args.recordings, file, args.force, out);
    }
    let files = all_recordings(&args.recordings)?;
    serve::run(serve::offers(&files)?, &args.service(), out)
}

impl ReplayArgs {
    fn service(&self) -> serve::Service<'_> {
        serve::Service {
            port: self.port,
            origins: &self.allow_origin,
        }
    }
}
