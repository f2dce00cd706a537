//! A run in progress. A run that was stopped in any way is repeated from its beginning: the same plan
//! gives the same bytes, so files that are already complete stay as they are.

use std::ops::ControlFlow;

use super::error;
use super::facts::run_info;
use super::folder::RunFolder;
use super::page::page_of;
use crate::episode::Observer;
use crate::picture::{Camera, Look, Stages};
use crate::record::resume_hint::resume_hint;
use crate::record::{RecordMode, RecordSummary, Recorder};
use crate::trial::Trial;
use crate::{Error, ErrorKind};

/// The most cells of a maze of which a training writes the picture of the action values.
const MOST_PICTURED_CELLS: usize = 1 << 12;

/// A recorded run in progress, in a locked folder.
pub struct Session {
    folder: RunFolder,
    trial: Trial,
    recorder: Recorder,
    /// `None` in a maze that is too large for the picture.
    camera: Option<Camera>,
}

/// The result of resuming a run.
pub enum Resumed {
    /// The run is repeated, and goes on.
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
}

impl Session {
    /// Begins a run in an empty folder, with a trial at its beginning.
    ///
    /// # Errors
    /// If a file of the run cannot be written.
    pub fn begin(folder: RunFolder, trial: Trial, mode: RecordMode) -> Result<Self, Error> {
        let plan = trial.plan();
        // Save this first, so that the run can be resumed whenever it is stopped from here on.
        folder.save_unfinished(plan, mode)?;
        folder.save_plan(plan)?;
        let recorder = Recorder::create(folder.path(), &plan.maze, run_info(plan), mode)?;
        Ok(Self::new(folder, trial, recorder))
    }

    /// Resumes the run in a folder: repeats it from its beginning, without writing the files of
    /// episodes that are complete.
    ///
    /// # Errors
    /// If the plan of the run is missing, damaged or of another version. If the settings or the
    /// world were changed by hand. If a foreign file would be replaced.
    pub fn resume(folder: RunFolder) -> Result<Resumed, Error> {
        let Some((plan, mode)) = folder.unfinished()? else {
            return Ok(Resumed::Finished(folder));
        };
        let trial = Trial::new(plan)?;
        let plan = trial.plan();
        folder.check_untouched(plan)?;
        folder.save_plan(plan)?;
        let recorder = Recorder::repeat(folder.path(), &plan.maze, run_info(plan), mode)?;
        let session = Self::new(folder, trial, recorder);
        Ok(Resumed::Unfinished(Box::new(session)))
    }

    fn new(folder: RunFolder, trial: Trial, recorder: Recorder) -> Self {
        let plan = trial.plan();
        let cells = usize::from(plan.maze.width()) * usize::from(plan.maze.height());
        let is_pictured = cells <= MOST_PICTURED_CELLS;
        Self {
            folder,
            camera: is_pictured.then(|| Camera::new(Stages::OfLearning, plan)),
            trial,
            recorder,
        }
    }

    /// Returns the trial in its current state.
    pub fn trial(&self) -> &Trial {
        &self.trial
    }

    /// Runs the episodes and saves the learned knowledge. `observer` sees every step after it was
    /// recorded. The run is stopped after the first episode at whose end `stop` returns true.
    ///
    /// # Errors
    /// [`ErrorKind::Interrupted`] if the run was stopped. Otherwise if a file cannot be written, or
    /// the file of a repeated episode differs.
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
        let plan = self.trial.plan();
        if shows_all && !plan.maze.is_too_large() {
            let page = page_of(self.folder.path(), plan, &knowledge)?;
            self.folder.save_page(&page)?;
        }
        if let Some(camera) = self.camera.filter(|_| plan.config.episodes > 0) {
            let picture = camera.picture(plan, Look::ActionValues);
            self.folder.save_picture(&picture.svg())?;
        }
        self.folder.remove_unfinished()?;
        Ok(Finished {
            trial: self.trial,
            folder: self.folder,
            recording,
        })
    }

    fn episodes(
        &mut self,
        observer: &mut dyn Observer,
        stop: &dyn Fn() -> bool,
    ) -> Result<(), Error> {
        while !self.trial.is_finished() {
            let camera: &mut dyn Observer = match &mut self.camera {
                Some(camera) => camera,
                None => &mut (),
            };
            let mut observers = ((&mut self.recorder, camera), &mut *observer);
            let (_, flow) = self.trial.run_episode(&mut observers);
            self.recorder.check()?;
            if flow == ControlFlow::Break(()) || stop() {
                return Err(self.interrupted());
            }
        }
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
