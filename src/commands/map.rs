//! `xcscr map`: draws the policy, or the value of every action, over the maze.

use std::path::{Path, PathBuf};

use xcscr::ErrorKind;
use xcscr::disk;
use xcscr::picture::Look;
use xcscr::run::{RecordedRun, RunFolder, RunInputs};
use xcscr::trial::Plan;

use super::failure::Failure;
use super::output::OutputFile;

/// Arguments of `map`.
#[derive(Debug, clap::Args)]
pub struct MapArgs {
    /// Folder of a run, or one of its recordings.
    run: PathBuf,
    /// Picture to write: an .svg file.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Draw the value (the paper's worth) of every action. Without an episode, draw three stages of learning: before
    /// the first success, when half of the shortest path is positive, and the last success. A chart below them shows
    /// by how much the optimal actions are better than the others.
    #[arg(long)]
    worth: bool,
    /// Show what was learned after this episode [default: that of the recording, or the last].
    #[arg(long, value_name = "N")]
    episode: Option<u32>,
    /// Replace the picture if it exists.
    #[arg(long)]
    force: bool,
}

/// Repeats the trial and draws what was learned.
pub fn run(args: &MapArgs) -> Result<(), Failure> {
    require_svg(&args.output)?;
    let file = OutputFile::free(&args.output, args.force)?;
    let (plan, shown) = plan(args)?;
    let look = if args.worth {
        Look::ActionValues
    } else {
        Look::Policy
    };
    let picture = RunInputs::training(plan).picture(args.episode.or(shown), look)?;
    file.write(picture.svg().as_bytes())
}

/// Rejects file names that do not end in `.svg`.
pub(super) fn require_svg(file: &Path) -> Result<(), Failure> {
    let extension = file.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("svg") {
        return Ok(());
    }
    let message = format!(
        "{} is not a picture file name: it must end in .svg",
        file.display()
    );
    Err(Failure::new(ErrorKind::Usage, message))
}

/// Returns the plan of a run, and the episode of a recording.
fn plan(args: &MapArgs) -> Result<(Plan, Option<u32>), Failure> {
    if args.run.exists() && !args.run.is_dir() {
        let source = RecordedRun::of(&args.run)?;
        source.require_method()?;
        return Ok((source.run.plan, source.extent.episode()));
    }
    let folder = RunFolder::open(&args.run);
    let plan = folder.plan()?;
    if args.episode.is_none() && folder.is_interrupted() {
        let message = format!(
            "{} is interrupted: finish it with `xcscr train --resume {}`, or choose an episode \
             with `--episode`",
            args.run.display(),
            disk::typed(&args.run)
        );
        return Err(Failure::new(ErrorKind::BadData, message));
    }
    Ok((plan, None))
}
