//! Recorded evaluations.

use std::io;
use std::ops::ControlFlow;
use std::path::Path;

use super::contents::{file_names, is_of_a_run, is_of_a_training};
use super::error;
use super::facts::run_info;
use super::folder::RunFolder;
use crate::agent::Knowledge;
use crate::disk;
use crate::episode::{Episode, Learned, Observer};
use crate::record::{RecordMode, RecordSummary, Recorder, RecordingKind, RunInfo, RunKind};
use crate::trial::{Evaluation, Plan, PlanError};
use crate::{Error, ErrorKind};

/// Runs `episodes` episodes of the greedy policy of `knowledge`.
///
/// # Errors
/// If the plan is invalid or the knowledge does not fit the world. [`ErrorKind::Interrupted`] if
/// `stop` returned true after an episode.
pub fn evaluate(
    plan: &Plan,
    knowledge: &Knowledge,
    episodes: u32,
    stop: &dyn Fn() -> bool,
) -> Result<Evaluation, Error> {
    observe(plan, knowledge, episodes, &mut (), stop)
}

/// Like [`evaluate`], with an observer.
pub(crate) fn observe(
    plan: &Plan,
    knowledge: &Knowledge,
    episodes: u32,
    observer: &mut dyn Observer,
    stop: &dyn Fn() -> bool,
) -> Result<Evaluation, Error> {
    let mut observers = (observer, Until(stop));
    let evaluation = Evaluation::observed(plan, knowledge, episodes, &mut observers)?;
    match stop() {
        true => Err(ErrorKind::Interrupted.error("interrupted")),
        false => Ok(evaluation),
    }
}

/// Runs `episodes` episodes of the greedy policy of `knowledge`, and records all of them in
/// `folder`, which must be missing or empty. With `force`, the files of an earlier evaluation,
/// finished or not, are removed, and nothing else.
///
/// # Errors
/// If the folder contains other files, the plan is invalid, the knowledge does not fit the world, or
/// a file cannot be written. [`ErrorKind::Interrupted`] if `stop` returned true after an episode; no
/// file is left.
pub fn record_evaluation(
    plan: &Plan,
    knowledge: &Knowledge,
    episodes: u32,
    (folder, force): (&Path, bool),
    stop: &dyn Fn() -> bool,
) -> Result<(Evaluation, RecordSummary), Error> {
    clear_evaluation(folder, force)?;
    let recorded = record_drives(plan, knowledge, episodes, folder, (RecordMode::All, stop));
    match recorded {
        Err(error) if error.kind() == ErrorKind::Interrupted => {
            clear_evaluation(folder, true)?;
            Err(error.with_hint("nothing was saved: run the same command again"))
        }
        recorded => recorded,
    }
}

/// Removes the files of an earlier evaluation, or returns an error without `force`.
fn clear_evaluation(folder: &Path, force: bool) -> Result<(), Error> {
    let entries = match file_names(folder) {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(()),
        names => names.map_err(disk::cannot_read(folder))?,
    };
    if entries.is_empty() {
        return Ok(());
    }
    let names = entries.iter().cloned();
    let mut names: Vec<String> = names.filter_map(|name| name.into_string().ok()).collect();
    let run = RecordingKind::Run.file_name();
    // An interrupted evaluation has an unfinished `run.mcap`, but no files of a training.
    let is_unfinished = |names: &[String]| {
        names.contains(&format!("{run}.part")) && !names.iter().any(|name| is_of_a_training(name))
    };
    let is_evaluation = RunFolder::open(folder).is_evaluation() || is_unfinished(&names);
    if !is_evaluation || names.len() < entries.len() || !names.iter().all(|name| is_of_a_run(name))
    {
        return Err(error::foreign(folder));
    }
    if !force {
        return Err(error::exists(folder));
    }
    // Remove `run.mcap` last, because it identifies the folder as an evaluation.
    names.retain(|name| *name != run);
    names.push(run);
    for name in names {
        let path = folder.join(name);
        disk::remove(&path).map_err(disk::cannot_write(&path))?;
    }
    Ok(())
}

/// Records an evaluation in a recording mode.
pub(super) fn record_drives(
    plan: &Plan,
    knowledge: &Knowledge,
    episodes: u32,
    folder: &Path,
    (mode, stop): (RecordMode, &dyn Fn() -> bool),
) -> Result<(Evaluation, RecordSummary), Error> {
    let plan = evaluation_plan(plan, knowledge, episodes)?;
    let Plan { maze, config } = &plan;
    let info = RunInfo {
        kind: RunKind::Evaluation,
        ..run_info(&plan)
    };
    let mut recorder = Recorder::create(folder, maze, info, mode)?;
    let policy = config.policy(knowledge.clone(), maze);
    recorder.warm_start(&*policy, maze);
    let evaluation = observe(&plan, knowledge, episodes, &mut recorder, stop)?;
    Ok((evaluation, recorder.finish(&*policy)?))
}

/// Stops an evaluation after an episode.
struct Until<'a>(&'a dyn Fn() -> bool);

impl Observer for Until<'_> {
    fn ended(&mut self, _: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        match (self.0)() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

/// Returns the plan of an evaluation of `knowledge`, if the knowledge fits the world of the plan.
pub(super) fn evaluation_plan(
    plan: &Plan,
    knowledge: &Knowledge,
    episodes: u32,
) -> Result<Plan, PlanError> {
    let mut plan = plan.clone().settled();
    plan.config.episodes = episodes;
    plan.config.initial = None;
    plan.check()?;
    let Plan { maze, config } = &plan;
    knowledge.check(config.perception(), maze)?;
    Ok(plan)
}
