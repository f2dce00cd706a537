//! Evaluations of a policy.

use std::ops::ControlFlow;
use std::path::Path;

use super::facts::run_info;
use crate::agent::Knowledge;
use crate::episode::{AfterEpisode, Episode, Observer};
use crate::record::{RecordMode, Recorder, RunInfo, RunKind};
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
    if stop() {
        Err(ErrorKind::Interrupted.error("interrupted"))
    } else {
        Ok(evaluation)
    }
}

/// Records episodes of the greedy policy of `knowledge` in a folder.
pub(super) fn record_drives(
    plan: &Plan,
    knowledge: &Knowledge,
    episodes: u32,
    folder: &Path,
) -> Result<(), Error> {
    let plan = evaluation_plan(plan, knowledge, episodes)?;
    let Plan { maze, config } = &plan;
    let info = RunInfo {
        kind: RunKind::Evaluation,
        ..run_info(&plan)
    };
    let mut recorder = Recorder::create(folder, maze, info, RecordMode::All)?;
    let policy = config.policy(knowledge.clone(), maze);
    recorder.warm_start(&*policy, maze);
    Evaluation::observed(&plan, knowledge, episodes, &mut recorder)?;
    recorder.finish(&*policy)?;
    Ok(())
}

/// Stops an evaluation after an episode.
struct Until<'a>(&'a dyn Fn() -> bool);

impl Observer for Until<'_> {
    fn ended(&mut self, _: &Episode, _: &AfterEpisode<'_>) -> ControlFlow<()> {
        if (self.0)() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
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
