//! `xcscr study task`: runs one task of a planned study.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use xcscr::ErrorKind;
use xcscr::study::StudyFolder;

use super::progress::StudyProgress;
use crate::commands::failure::Failure;
use crate::commands::interrupt::Interrupt;
use crate::commands::terminal::say;

/// Arguments of `study task`.
#[derive(Debug, clap::Args)]
pub struct TaskArgs {
    /// The folder of a planned study.
    folder: PathBuf,
    /// The task, counted from 1.
    task: usize,
    /// Number of parallel trials; 0 for as many as there are cores.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    jobs: u16,
    /// Do not show progress.
    #[arg(long)]
    quiet: bool,
}

/// Runs the missing trials of a task. Failed trials are results, which the report lists.
pub(super) fn run(args: &TaskArgs) -> Result<(), Failure> {
    let mut folder = StudyFolder::read(&args.folder)?;
    let task = args.task;
    let finished = Arc::new(AtomicUsize::new(0));
    let counter = finished.clone();
    let shutdown_message = move || interrupted(task, counter.load(Ordering::Relaxed));
    let mut progress = StudyProgress::new(args.quiet, Interrupt::watch(shutdown_message)?)
        .counting(finished.clone());
    let watch = &mut |finished, trials| progress.watch(finished, trials);
    folder.run_task(task, args.jobs.into(), watch)?;
    drop(progress);
    let finished = finished.load(Ordering::Relaxed);
    if !folder.missing_of_task(task).is_empty() {
        return Err(interrupted(task, finished));
    }
    if !args.quiet {
        say(&format!(
            "task {task}: all its trials are finished, {finished} of them in this run"
        ));
    }
    Ok(())
}

/// Returns the failure after a signal. A task that finished no trial would not finish one when
/// repeated either.
fn interrupted(task: usize, finished: usize) -> Failure {
    match finished {
        0 => Failure::new(
            ErrorKind::Refuted,
            format!(
                "task {task} was interrupted before one of its trials ended: give it more time"
            ),
        ),
        _ => Failure::new(
            ErrorKind::Interrupted,
            format!(
                "task {task} was interrupted after {finished} more trials; run it again to resume it"
            ),
        ),
    }
}
