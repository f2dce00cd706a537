//! A run in a folder, from its beginning or from a checkpoint: it loses at most a moment of work,
//! however it is stopped.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use xcscr::disk;
use xcscr::record::{RecordMode, RecordSummary, Recorder, RecorderMemory};
use xcscr::run::RunFolder;
use xcscr::trial::{Checkpoint, Plan, Trial};

use super::failure::{Exit, Failure};
use super::interrupt::Interrupt;
use super::live::Broadcast;
use super::progress::Progress;
use super::train;

/// Checkpoints may cost one part in so many of the time ...
const SHARE: u32 = 50;
/// ... and are at most so far apart.
const RAREST: Duration = Duration::from_secs(60);
/// How long `--live` waits for a viewer: long enough to open one, and a script is not stuck.
const VIEWER_WAIT: Duration = Duration::from_secs(60);

/// What a checkpoint holds.
#[derive(Serialize, Deserialize)]
struct State {
    trial: Checkpoint,
    recorder: RecorderMemory,
}

/// A run that is under way.
pub struct Session {
    folder: RunFolder,
    trial: Trial,
    observers: (Recorder, Progress),
    interrupt: Interrupt,
    next_checkpoint: Instant,
}

impl Session {
    /// Begins a run in a folder that is empty.
    pub fn begin(
        folder: RunFolder,
        trial: Trial,
        mode: RecordMode,
        quiet: bool,
    ) -> Result<Self, Failure> {
        let interrupt = watch(&folder)?;
        let plan = trial.plan();
        // First, so that the run can be resumed whenever it is stopped from here on.
        folder.save_checkpoint(&State {
            trial: trial.checkpoint(),
            recorder: RecorderMemory::new(mode),
        })?;
        folder.save_plan(plan)?;
        let recorder = train::recorder(folder.path(), plan, mode)?;
        Ok(Self::new(folder, trial, recorder, interrupt, quiet))
    }

    /// Goes on with the run in a folder; gives the folder back when the run is finished.
    pub fn resume(path: &Path, quiet: bool) -> Result<Result<Self, RunFolder>, Failure> {
        let folder = RunFolder::resume(path)?;
        let interrupt = watch(&folder)?;
        let Some(State { trial, recorder }) = folder.checkpoint()? else {
            return Ok(Err(folder));
        };
        let trial = Trial::resume(&trial).map_err(|fault| folder.bad_checkpoint(fault))?;
        let plan = trial.plan();
        folder.save_plan(plan)?;
        let info = train::run_info(plan)?;
        let policy = trial.policy();
        let recorder = Recorder::resume(folder.path(), &plan.maze, info, recorder, policy)?;
        Ok(Ok(Self::new(folder, trial, recorder, interrupt, quiet)))
    }

    fn new(
        folder: RunFolder,
        trial: Trial,
        recorder: Recorder,
        interrupt: Interrupt,
        quiet: bool,
    ) -> Self {
        let Plan { config, .. } = trial.plan();
        let progress = Progress::new(config.episodes, quiet).after(trial.progress());
        Self {
            folder,
            trial,
            observers: (recorder, progress),
            interrupt,
            next_checkpoint: Instant::now(),
        }
    }

    /// Waits a while for a viewer, and from now on streams what is recorded.
    pub fn stream(&mut self, mut broadcast: Broadcast) {
        broadcast.wait_for_viewer(VIEWER_WAIT);
        let tap = move |topic, time_ns, data: &[u8]| broadcast.send(topic, time_ns, data);
        self.observers.0.tap(Box::new(tap));
    }

    /// Runs what is left, and saves what was learned. Gives the trial, its folder and what was
    /// recorded.
    pub fn run(mut self) -> Result<(Trial, RunFolder, RecordSummary), Failure> {
        let way_on = way_on(&self.folder);
        let hint = |failure: Failure| match failure.exit {
            Exit::Io | Exit::CannotCreate => failure.and(&way_on),
            _ => failure,
        };
        self.episodes().map_err(hint)?;
        let Self {
            folder,
            trial,
            observers,
            ..
        } = self;
        let (recorder, progress) = observers;
        drop(progress);
        let recording = recorder.finish(trial.method());
        let recording = recording.map_err(|error| hint(error.into()))?;
        let saved = folder.save_knowledge(&trial.method().knowledge());
        saved
            .and_then(|()| folder.remove_checkpoint())
            .map_err(|error| hint(error.into()))?;
        Ok((trial, folder, recording))
    }

    fn episodes(&mut self) -> Result<(), Failure> {
        while !self.trial.is_finished() {
            if self.trial.run_episode(&mut self.observers).1 == ControlFlow::Break(()) {
                // A break comes from the recorder, whose error this gives out.
                self.save()?;
            }
            if self.interrupt.came() {
                self.save()?;
                return Err(self.interrupted());
            }
            if Instant::now() >= self.next_checkpoint {
                self.save()?;
            }
        }
        Ok(())
    }

    /// Makes a checkpoint, and plans the next one by what this one cost.
    fn save(&mut self) -> Result<(), Failure> {
        let begun = Instant::now();
        let state = State {
            recorder: self.observers.0.memory()?,
            trial: self.trial.checkpoint(),
        };
        self.folder.save_checkpoint(&state)?;
        let pause = (begun.elapsed() * SHARE).min(RAREST);
        self.next_checkpoint = Instant::now() + pause;
        Ok(())
    }

    fn interrupted(&self) -> Failure {
        let (done, all) = (
            self.trial.progress().episodes,
            self.trial.plan().config.episodes,
        );
        let way_on = way_on(&self.folder);
        let message = format!("interrupted after episode {done} of {all}; {way_on}");
        Failure::new(Exit::Interrupted, message)
    }
}

/// Watches for signals from the moment on at which the folder is this process's own.
fn watch(folder: &RunFolder) -> Result<Interrupt, Failure> {
    let farewell = format!("interrupted in an episode; {}", way_on(folder));
    Ok(Interrupt::watch(farewell)?)
}

fn way_on(folder: &RunFolder) -> String {
    let path = disk::typed(folder.path());
    format!("go on with `xcscr train --resume {path}`")
}
