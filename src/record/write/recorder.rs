//! Which files there are, and when they are made, kept and given up.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::event_logger::EventLogger;
use super::log_file::OpenFile;
use super::outbox::{Outbox, Tap};
use super::rebuild::{self, Chunks};
use super::sink::Packing;
use crate::agent::Agent;
use crate::arena::View;
use crate::disk;
use crate::episode::{Ending, Episode, Learned, Observer, PolicyMap, Step};
use crate::record::error::RecordError;
use crate::record::info::{RecordingKind, RunInfo};
use crate::record::layout;
use crate::record::mode::RecordMode;
use crate::record::topics::Topic;
use crate::record::topics::curve::Curve;
use crate::world::Maze;

/// Writes one MCAP file per episode, `ep-0001.mcap` and so on, and `run.mcap` with what happens
/// once per step or more rarely. The same run gives the same bytes.
///
/// A file is called `NAME.mcap.part` until it is whole and safely on the disk. After the first
/// error nothing more is written: [`Observer::ended`] then ends the trial, and
/// [`finish`](Self::finish) gives the error out.
///
/// All files carry the run's facts: the attachments `world.json` and `config.json`, and the
/// metadata record `run`. The layout is attached to `run.mcap` only: it was a tenth of what an
/// episode took, no viewer looks for it there, and it lies beside the files. The rules, some hundred kilobytes that
/// MCAP does not compress, are attached to `run.mcap` as they are at the end, and to the episode
/// that [`RecordMode::Best`] keeps; those of any other episode come from running it again.
pub struct Recorder {
    folder: PathBuf,
    info: RunInfo,
    mode: RecordMode,
    world: String,
    /// Of the recordings of episodes, and of that of the run.
    layouts: [String; 2],
    event_logger: EventLogger,
    outbox: Outbox,
    /// The episodes whose files are kept, with their sizes in bytes.
    kept: Vec<(u32, u64)>,
    /// Steps of the episode that is the best so far.
    best: Option<u32>,
    clock_ns: u64,
    error: Option<RecordError>,
}

/// What a recorder keeps between two episodes, beside the files on the disk.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecorderMemory {
    mode: RecordMode,
    /// Messages in `run.mcap`.
    messages: u64,
    kept: Vec<(u32, u64)>,
    best: Option<u32>,
    clock_ns: u64,
    event_logger: (Curve, bool),
}

impl RecorderMemory {
    /// Before anything was recorded.
    pub fn new(mode: RecordMode) -> Self {
        Self {
            mode,
            messages: 0,
            kept: Vec::new(),
            best: None,
            clock_ns: 0,
            event_logger: (Curve::default(), false),
        }
    }
}

/// What a recorder leaves behind.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RecordSummary {
    /// The recordings, episodes first, `run.mcap` last.
    pub files: Vec<PathBuf>,
    /// Their sizes together, in bytes.
    pub bytes: u64,
}

impl Recorder {
    /// Makes `folder` if it is missing, lays both layouts into it and begins `run.mcap`; older
    /// files of these names are replaced. With [`RecordMode::None`] it does nothing at all.
    ///
    /// # Errors
    /// [`RecordError::Create`] when the folder or a file in it cannot be made.
    pub fn create(
        folder: &Path,
        maze: &Maze,
        info: RunInfo,
        mode: RecordMode,
    ) -> Result<Self, RecordError> {
        let mut recorder = Self::new(folder, maze, info, mode);
        if mode != RecordMode::None {
            recorder.lay_out()?;
            recorder.outbox.run = Some(recorder.open_run("part", Packing::Quick)?);
        }
        Ok(recorder)
    }

    /// Goes on where a recorder was of which this is the memory; `learned` is what the episodes
    /// before taught. What `run.mcap.part` holds beyond them is given up, because the episodes
    /// after them will be run again.
    ///
    /// # Errors
    /// When `run.mcap.part` is missing, damaged or too short, or a file cannot be made.
    pub fn resume(
        folder: &Path,
        maze: &Maze,
        info: RunInfo,
        memory: RecorderMemory,
        learned: PolicyMap,
    ) -> Result<Self, RecordError> {
        if memory.mode == RecordMode::None || memory.messages == 0 {
            return Self::create(folder, maze, info, memory.mode);
        }
        let mut recorder = Self::new(folder, maze, info, memory.mode);
        recorder.lay_out()?;
        recorder.outbox.run = Some(recorder.rebuilt_run(memory.messages)?);
        recorder
            .event_logger
            .resume(memory.event_logger, learned, maze);
        recorder.kept = memory.kept;
        recorder.best = memory.best;
        recorder.clock_ns = memory.clock_ns;
        Ok(recorder)
    }

    /// `run.mcap.part` with its first `messages` messages only. When the run was stopped on its
    /// last steps, it may have its final name already.
    fn rebuilt_run(&self, messages: u64) -> Result<OpenFile, RecordError> {
        let whole = self.folder.join(RecordingKind::Run.file_name());
        let part = disk::part(&whole);
        let is_whole = whole.exists() && !part.exists();
        let source = if is_whole { whole } else { part };
        // First, so that a recording that is missing leaves the folder as it is.
        let opened = disk::open(&source).map(drop);
        opened.map_err(|cause| RecordError::Read {
            path: source.clone(),
            cause,
        })?;
        // Aside, so that nothing is lost if this is stopped, too.
        let mut run = self.open_run("again", Packing::Quick)?;
        rebuild::copy(&source, messages, Chunks::AsBefore, &mut run)?;
        run.become_part()?;
        Ok(run)
    }

    fn new(folder: &Path, maze: &Maze, info: RunInfo, mode: RecordMode) -> Self {
        Self {
            folder: folder.to_owned(),
            mode,
            world: maze.name().to_owned(),
            layouts: [layout::of_episode(maze), layout::of_run(maze)],
            event_logger: EventLogger::new(maze, &info, mode == RecordMode::Beams),
            info,
            outbox: Outbox::default(),
            kept: Vec::new(),
            best: None,
            clock_ns: 0,
            error: None,
        }
    }

    /// Shows from the first moment what was learned elsewhere.
    pub fn know(&mut self, method: &dyn Agent, maze: &Maze) {
        self.event_logger.know(method, self.info.sensor, maze);
    }

    /// Which episodes are kept.
    pub fn mode(&self) -> RecordMode {
        self.mode
    }

    /// From now on also tells `tap` what the files of episodes are told, kept or not.
    pub fn tap(&mut self, tap: Tap) {
        self.outbox.tap = Some(tap);
    }

    /// What is needed to go on after the last episode; brings the files of all episodes so far
    /// safely to the disk.
    ///
    /// # Errors
    /// The first error of the whole recording.
    pub fn memory(&mut self) -> Result<RecorderMemory, RecordError> {
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        let run = self.outbox.run.as_ref();
        run.map_or(Ok(()), OpenFile::sync)?;
        Ok(RecorderMemory {
            mode: self.mode,
            messages: run.map_or(0, OpenFile::messages),
            kept: self.kept.clone(),
            best: self.best,
            clock_ns: self.clock_ns,
            event_logger: self.event_logger.memory(),
        })
    }

    /// Finishes `run.mcap` with the rules that `method` ended with.
    ///
    /// # Errors
    /// The first error of the whole recording; unfinished files are kept as `.part`.
    pub fn finish(mut self, method: &dyn Agent) -> Result<RecordSummary, RecordError> {
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        let kept = std::mem::take(&mut self.kept).into_iter();
        let mut files: Vec<_> = kept
            .map(|(episode, bytes)| {
                (
                    self.folder
                        .join(RecordingKind::Episode(episode).file_name()),
                    bytes,
                )
            })
            .collect();
        if let Some(run) = self.outbox.run.take() {
            files.push(self.pack(run, &rules_json(method))?);
        }
        Ok(RecordSummary {
            bytes: files.iter().map(|(_, bytes)| bytes).sum(),
            files: files.into_iter().map(|(path, _)| path).collect(),
        })
    }

    /// Finishes `run.mcap` in fewer bytes. While it grew, each episode closed a chunk, so that it
    /// was safe; now that it is whole, episodes that look alike share one.
    fn pack(&self, mut run: OpenFile, rules: &str) -> Result<(PathBuf, u64), RecordError> {
        run.with(|log| log.flush())?;
        let part = disk::part(&self.folder.join(RecordingKind::Run.file_name()));
        let mut packed = self.open_run("again", Packing::Small)?;
        rebuild::copy(&part, run.messages(), Chunks::Full, &mut packed)?;
        packed.with(|log| log.attach("rules.json", self.clock_ns, rules))?;
        let finished = packed.finish()?;
        run.discard()?;
        Ok(finished)
    }

    /// Makes the folder and lays both layouts into it.
    fn lay_out(&self) -> Result<(), RecordError> {
        fs::create_dir_all(&self.folder).map_err(|cause| RecordError::Create {
            path: self.folder.clone(),
            cause,
        })?;
        let names = ["foxglove-layout.json", "foxglove-layout-run.json"];
        for (name, text) in names.into_iter().zip(&self.layouts) {
            let path = self.folder.join(name);
            disk::replace(&path, text.as_bytes())
                .map_err(|cause| RecordError::Create { path, cause })?;
        }
        Ok(())
    }

    fn open_run(&self, extension: &str, packing: Packing) -> Result<OpenFile, RecordError> {
        let name = RecordingKind::Run.file_name();
        let file = OpenFile::create_as(&self.folder, &name, extension, packing)?;
        self.introduce(file, RecordingKind::Run, &Topic::of_run())
    }

    /// Begins a file with the facts of the run and its topics.
    fn introduce(
        &self,
        mut file: OpenFile,
        extent: RecordingKind,
        topics: &[Topic],
    ) -> Result<OpenFile, RecordError> {
        file.with(|log| {
            log.metadata("run", self.info.metadata(&self.world, self.mode, extent))?;
            log.attach("world.json", self.clock_ns, &self.info.world_json)?;
            log.attach("config.json", self.clock_ns, &self.info.config_json)?;
            if extent == RecordingKind::Run {
                let [_, layout] = &self.layouts;
                log.attach("foxglove-layout.json", self.clock_ns, layout)?;
            }
            log.declare(extent, topics)
        })?;
        Ok(file)
    }

    fn begin(&mut self, episode: u32, view: &View<'_>) -> Result<(), RecordError> {
        self.clock_ns = view.now().time_ns;
        if self.mode.wants(episode) {
            let file =
                OpenFile::create(&self.folder, &RecordingKind::Episode(episode).file_name())?;
            let file = self.introduce(
                file,
                RecordingKind::Episode(episode),
                &Topic::of_episode(view.sensed.is_some(), self.mode == RecordMode::Beams),
            )?;
            self.outbox.episode = Some(file);
        }
        self.event_logger.began(&mut self.outbox, episode, view)
    }

    fn end(&mut self, episode: &Episode, learned: &Learned<'_>) -> Result<(), RecordError> {
        self.clock_ns = learned.view.now().time_ns;
        self.event_logger
            .ended(&mut self.outbox, episode, learned)?;
        if let Some(run) = &mut self.outbox.run {
            run.with(|log| log.flush())?;
        }
        match self.outbox.episode.take() {
            Some(file) => self.keep(file, episode, learned.method),
            None => Ok(()),
        }
    }

    /// Finishes an episode's file or gives it up; drops the one that it replaces.
    fn keep(
        &mut self,
        mut file: OpenFile,
        episode: &Episode,
        method: &dyn Agent,
    ) -> Result<(), RecordError> {
        if self.mode == RecordMode::Best {
            let is_best = self.best.is_none_or(|best| episode.steps < best);
            if episode.ending != Ending::Goal || !is_best {
                return file.discard();
            }
            self.best = Some(episode.steps);
            let rules = rules_json(method);
            file.with(|log| log.attach("rules.json", self.clock_ns, &rules))?;
        }
        let (_, bytes) = file.finish()?;
        if matches!(self.mode, RecordMode::Best | RecordMode::Last) {
            self.drop_kept()?;
        }
        self.kept.push((episode.episode, bytes));
        Ok(())
    }

    fn drop_kept(&mut self) -> Result<(), RecordError> {
        for (episode, _) in std::mem::take(&mut self.kept) {
            let path = self
                .folder
                .join(RecordingKind::Episode(episode).file_name());
            // It is gone already when this episode is run for the second time.
            disk::remove(&path).map_err(|cause| RecordError::Write {
                path,
                cause: cause.to_string(),
            })?;
        }
        Ok(())
    }

    /// Does something unless there was an error before; keeps the first one.
    fn attempt(&mut self, act: impl FnOnce(&mut Self) -> Result<(), RecordError>) {
        let is_heard = self.mode != RecordMode::None || self.outbox.tap.is_some();
        if self.error.is_none() && is_heard {
            self.error = act(self).err();
        }
    }
}

impl Observer for Recorder {
    fn began(&mut self, episode: u32, view: &View<'_>) {
        self.attempt(|recorder| recorder.begin(episode, view));
    }

    fn stepped(&mut self, step: &Step<'_>) {
        self.attempt(|recorder| recorder.event_logger.stepped(&mut recorder.outbox, step));
    }

    fn ended(&mut self, episode: &Episode, learned: &Learned<'_>) -> ControlFlow<()> {
        self.attempt(|recorder| recorder.end(episode, learned));
        match self.error {
            Some(_) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        }
    }
}

/// What a learner knows, as the text of `rules.json`.
fn rules_json(method: &dyn Agent) -> String {
    serde_json::to_string(&method.knowledge()).expect("knowledge is plain data")
}
