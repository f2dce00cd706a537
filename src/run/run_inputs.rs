//! Repeats recorded runs.

use std::path::Path;

use super::external::{ExternalEpisode, record_external};
use super::facts::run_info;
use crate::Error;
use crate::agent::Knowledge;
use crate::episode::Observer;
use crate::picture::{Look, PolicyPicture};
use crate::record::{RecordMode, Recorder};
use crate::trial::{Plan, Trial};

/// What determines the episodes of a run: a training, or the episodes of an external agent.
#[derive(Debug, Clone, PartialEq)]
pub struct RunInputs {
    /// The plan.
    pub plan: Plan,
    /// The episodes, if an external agent chose the actions.
    pub external: Option<Vec<ExternalEpisode>>,
}

impl RunInputs {
    /// Returns the training of a plan.
    pub fn training(plan: Plan) -> Self {
        Self {
            plan,
            external: None,
        }
    }

    /// Repeats a training until `observer` breaks. Returns the knowledge at the end.
    ///
    /// # Errors
    /// If the plan cannot be run.
    pub fn watch(&self, observer: &mut dyn Observer) -> Result<Knowledge, Error> {
        let mut trial = Trial::new(self.plan.clone())?;
        let _ = trial.run(observer);
        Ok(trial.method().knowledge())
    }

    /// Repeats the run as far as needed, and returns a picture of its policy or its action values after an episode.
    /// Without an episode: the policy after the last one, or the action values at three stages of learning.
    ///
    /// # Errors
    /// When the run cannot be repeated or has no such episode, or when the maze has more than a million
    /// cells.
    pub fn picture(&self, after: Option<u32>, look: Look) -> Result<PolicyPicture, Error> {
        PolicyPicture::of(&self.plan, after, look, |camera| self.watch(camera))
    }

    /// Repeats the run and records it in a folder. Returns the knowledge at the end. `observer`
    /// watches a training.
    pub(super) fn record(
        &self,
        folder: &Path,
        mode: RecordMode,
        observer: &mut dyn Observer,
    ) -> Result<Knowledge, Error> {
        let plan = &self.plan;
        if let Some(episodes) = &self.external {
            return record_external(plan, episodes, folder, mode);
        }
        let mut trial = Trial::new(plan.clone())?;
        let (maze, info) = (&trial.plan().maze, run_info(trial.plan()));
        let mut recorder = Recorder::create(folder, maze, info, mode)?;
        // The recorder breaks on errors, which `finish` returns.
        let _ = trial.run(&mut (&mut recorder, observer));
        recorder.finish(trial.method())?;
        Ok(trial.method().knowledge())
    }
}
