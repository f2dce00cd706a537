//! A run in progress, with checkpoints so that stopping it in any way loses little work.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::error;
use super::facts::run_info;
use super::folder::RunFolder;
use super::page::page_of;
use crate::episode::Observer;
use crate::error::{Error, ErrorKind};
use crate::record::resume_hint::resume_hint;
use crate::record::{RecordMode, RecordSummary, Recorder, RecorderMemory};
use crate::trial::{Checkpoint, Trial};

/// Checkpoints take at most 1/`SHARE` of the run time.
const SHARE: u32 = 50;
/// The maximum time between checkpoints.
const MAX_INTERVAL: Duration = Duration::from_secs(60);

/// The contents of a checkpoint.
#[derive(Serialize, Deserialize)]
struct State {
    trial: Checkpoint,
    recorder: RecorderMemory,
    steps: Vec<u32>,
}

/// A recorded run in progress, in a locked folder.
pub struct Session {
    folder: RunFolder,
    trial: Trial,
    recorder: Recorder,
    /// The number of steps of each episode so far.
    steps: Vec<u32>,
    next_checkpoint: Instant,
}

/// The result of resuming a run.
pub enum Resumed {
    /// The run continues from its checkpoint.
    Unfinished(Box<Session>),
    /// The run is already finished.
    Finished(RunFolder),
}

/// A finished run.
pub struct Finished {
    /// The trial with its learned knowledge.
    pub trial: Trial,
    /// The run's folder.
    pub folder: RunFolder,
    /// The recorded files.
    pub recording: RecordSummary,
    /// The number of steps of each episode, including those before the run was resumed.
    pub steps: Vec<u32>,
}

impl Session {
    /// Begins a run in an empty folder.
    ///
    /// # Errors
    /// If a file of the run cannot be written.
    pub fn begin(folder: RunFolder, trial: Trial, mode: RecordMode) -> Result<Self, Error> {
        let plan = trial.plan();
        // Save a checkpoint first, so that the run can be resumed whenever it is stopped from here
        // on.
        folder.save_checkpoint(&State {
            trial: trial.checkpoint(),
            recorder: RecorderMemory::new(mode),
            steps: Vec::new(),
        })?;
        folder.save_plan(plan)?;
        let recorder = Recorder::create(folder.path(), &plan.maze, run_info(plan), mode)?;
        Ok(Self::new(folder, trial, recorder, Vec::new()))
    }

    /// Resumes the run in a folder from its last checkpoint.
    ///
    /// # Errors
    /// If the checkpoint or a required recording is missing, damaged or inconsistent. If the
    /// settings or the world were changed by hand. If a foreign file would be replaced.
    pub fn resume(folder: RunFolder) -> Result<Resumed, Error> {
        let Some(State {
            trial,
            recorder,
            steps,
        }) = folder.checkpoint()?
        else {
            return Ok(Resumed::Finished(folder));
        };
        let trial = Trial::resume(&trial).map_err(|fault| folder.bad_checkpoint(fault))?;
        let plan = trial.plan();
        folder.check_untouched(plan)?;
        folder.save_plan(plan)?;
        let (info, policy) = (run_info(plan), trial.policy());
        let recorder = Recorder::resume(folder.path(), &plan.maze, info, recorder, policy)?;
        let session = Self::new(folder, trial, recorder, steps);
        Ok(Resumed::Unfinished(Box::new(session)))
    }

    fn new(folder: RunFolder, trial: Trial, recorder: Recorder, steps: Vec<u32>) -> Self {
        Self {
            folder,
            trial,
            recorder,
            steps,
            next_checkpoint: Instant::now(),
        }
    }

    /// Returns the trial in its current state.
    pub fn trial(&self) -> &Trial {
        &self.trial
    }

    /// Runs the remaining episodes and saves the learned knowledge. `observer` sees every step
    /// after it was recorded. The run is stopped with a checkpoint after the first episode at whose
    /// end `stop` returns true.
    ///
    /// # Errors
    /// [`ErrorKind::Interrupted`] if the run was stopped; otherwise if a file cannot be written.
    pub fn run(
        self,
        observer: &mut dyn Observer,
        stop: &dyn Fn() -> bool,
    ) -> Result<Finished, Error> {
        let folder = self.folder.path().to_owned();
        let finished = self.run_to_end(observer, stop);
        finished.map_err(|error| error::resumable_in(error, &folder))
    }

    fn run_to_end(
        mut self,
        observer: &mut dyn Observer,
        stop: &dyn Fn() -> bool,
    ) -> Result<Finished, Error> {
        self.episodes(observer, stop)?;
        let mode = self.recorder.mode();
        let recording = self.recorder.finish(self.trial.method())?;
        let knowledge = self.trial.method().knowledge();
        self.folder.save_knowledge(&knowledge)?;
        let shows_all = matches!(mode, RecordMode::All | RecordMode::Beams);
        if shows_all && !self.trial.plan().maze.is_too_large() {
            let page = page_of(self.folder.path(), self.trial.plan(), &knowledge)?;
            self.folder.save_page(&page)?;
        }
        self.folder.remove_checkpoint()?;
        Ok(Finished {
            trial: self.trial,
            folder: self.folder,
            recording,
            steps: self.steps,
        })
    }

    fn episodes(
        &mut self,
        observer: &mut dyn Observer,
        stop: &dyn Fn() -> bool,
    ) -> Result<(), Error> {
        while !self.trial.is_finished() {
            let mut observers = (&mut self.recorder, &mut *observer);
            let (episode, flow) = self.trial.run_episode(&mut observers);
            self.steps.push(episode.steps);
            // If the recorder failed, `save` returns its error.
            if flow == ControlFlow::Break(()) || stop() {
                self.save()?;
                return Err(self.interrupted());
            }
            if Instant::now() >= self.next_checkpoint {
                self.save()?;
            }
        }
        Ok(())
    }

    /// Saves a checkpoint. The time until the next one follows from the duration of this one.
    fn save(&mut self) -> Result<(), Error> {
        let begun = Instant::now();
        let state = State {
            recorder: self.recorder.memory()?,
            trial: self.trial.checkpoint(),
            steps: self.steps.clone(),
        };
        self.folder.save_checkpoint(&state)?;
        let pause = (begun.elapsed() * SHARE).min(MAX_INTERVAL);
        self.next_checkpoint = Instant::now() + pause;
        Ok(())
    }

    fn interrupted(&self) -> Error {
        let (done, all) = (
            self.trial.progress().episodes,
            self.trial.plan().config.episodes,
        );
        let hint = resume_hint(self.folder.path());
        let message = format!("interrupted after episode {done} of {all}; {hint}");
        ErrorKind::Interrupted.error(message)
    }
}
