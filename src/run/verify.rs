//! Verifies that a repeated run produces the same bytes.

use std::fs;
use std::io;

use tempfile::TempDir;

use super::error::RunError;
use super::evaluation::record_evaluation;
use super::external::{ExternalEpisode, record_external};
use super::facts::run_info;
use super::highlights::Material;
use super::source::Source;
use crate::agent::Knowledge;
use crate::episode::Observer;
use crate::record::{self, RecordMode, Recorder, RecordingKind};
use crate::trial::{Plan, Trial};

/// A repeated run in a temporary folder, which is deleted with this value.
pub struct Again {
    pub(super) plan: Plan,
    mode: RecordMode,
    is_evaluation: bool,
    external: Option<Vec<ExternalEpisode>>,
    /// The learned knowledge at the end.
    pub(super) knowledge: Knowledge,
    pub(super) folder: TempDir,
}

impl Again {
    /// Repeats the run of a recording, while `observer` watches.
    ///
    /// # Errors
    /// If the settings or the world are invalid, or a file cannot be written.
    pub fn new(source: &Source, observer: &mut dyn Observer) -> Result<Self, RunError> {
        let (plan, mode) = (&source.plan, source.mode);
        let folder = tempfile::tempdir().map_err(RunError::Temporary)?;
        let knowledge = if let Some(knowledge) = &source.evaluated {
            let episodes = plan.config.episodes;
            record_evaluation(plan, knowledge, episodes, folder.path(), &|| false)?;
            knowledge.clone()
        } else if let Some(episodes) = &source.external {
            record_external(plan, episodes, folder.path(), mode)?
        } else {
            return Self::train(plan, mode, observer);
        };
        Ok(Self {
            plan: plan.clone(),
            mode,
            is_evaluation: source.evaluated.is_some(),
            external: source.external.clone(),
            knowledge,
            folder,
        })
    }

    /// Runs and records a training.
    pub(super) fn train(
        plan: &Plan,
        mode: RecordMode,
        observer: &mut dyn Observer,
    ) -> Result<Self, RunError> {
        let folder = tempfile::tempdir().map_err(RunError::Temporary)?;
        let mut trial = Trial::new(plan.clone())?;
        let (maze, info) = (&trial.plan().maze, run_info(trial.plan()));
        let mut recorder = Recorder::create(folder.path(), maze, info, mode)?;
        // The recorder breaks on errors, which `finish` returns.
        let _ = trial.run(&mut (&mut recorder, observer));
        recorder.finish(trial.method())?;
        Ok(Self {
            plan: plan.clone(),
            mode,
            is_evaluation: false,
            external: None,
            knowledge: trial.method().knowledge(),
            folder,
        })
    }

    /// Returns true if another recording comes from the same run.
    pub fn serves(&self, source: &Source) -> bool {
        let same_rules = match &source.evaluated {
            Some(knowledge) => self.is_evaluation && *knowledge == self.knowledge,
            None => !self.is_evaluation,
        };
        self.mode == source.mode
            && self.plan == source.plan
            && same_rules
            && self.external == source.external
    }

    /// Returns the first difference between a recording and that of this run as text.
    ///
    /// # Errors
    /// If one of the two cannot be read.
    pub fn difference(&self, source: &Source) -> Result<Option<String>, RunError> {
        let name = source.extent.file_name();
        let folder = self.folder.path();
        let bytes = match source.extent {
            RecordingKind::Highlights => {
                Material::in_folder(folder, &self.plan, &self.knowledge)?.build()?
            }
            _ => match fs::read(folder.join(&name)) {
                Err(cause) if cause.kind() == io::ErrorKind::NotFound => {
                    let external = self.external.as_ref().map(Vec::len);
                    let episodes = external.unwrap_or(self.plan.config.episodes as usize);
                    let fault = format!("a new run of {episodes} episodes produces no {name}");
                    return Ok(Some(fault));
                }
                bytes => bytes.map_err(RunError::Temporary)?,
            },
        };
        let difference = record::compare(&source.bytes, &bytes)?;
        Ok(difference.map(|difference| difference.to_string()))
    }
}
