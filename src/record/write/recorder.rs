//! Creates, keeps and deletes the files of a recording.

use std::fs;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use mcap::McapResult;
use serde::{Deserialize, Serialize};

use super::event_logger::EventLogger;
use super::log_file::{Facts, LogFile, OpenFile};
use super::outbox::Outbox;
use super::rebuild;
use crate::agent::Agent;
use crate::arena::View;
use crate::disk;
use crate::episode::{Episode, Learned, Observer, PolicyMap, Step};
use crate::error::Error;
use crate::record::info::{RecordingKind, RunInfo};
use crate::record::layout;
use crate::record::mode::RecordMode;
use crate::record::topics::Topic;
use crate::record::topics::curve::Curve;
use crate::world::Maze;

/// Writes one MCAP file per episode, `ep-0001.mcap` and so on. `run.mcap` contains the events that
/// happen at most once per step. The same run produces the same bytes.
///
/// A file is called `NAME.mcap.part` until it is complete and synced to disk. After the first error
/// nothing more is written: [`Observer::ended`] then ends the trial, and [`finish`](Self::finish)
/// returns the error.
///
/// All files carry the run's facts: the attachments `world.json` and `config.json`, and the
/// metadata record `run`. The layout is next to the files, and attached to `run.mcap` only: it
/// would be a tenth of an episode's file, where no viewer looks for it.
///
/// The rules take some hundred kilobytes, which MCAP does not compress. The final rules are
/// attached to `run.mcap`. The rules of single episodes are obtained by repeating the run.
pub struct Recorder {
    folder: PathBuf,
    info: RunInfo,
    world: String,
    /// The layouts of episode recordings and of the run's recording.
    layouts: [String; 2],
    event_logger: EventLogger,
    outbox: Outbox,
    /// The state; `messages` and `event_logger` are filled in for a checkpoint.
    memory: RecorderMemory,
    /// Name and text of an additional attachment of `run.mcap`.
    attached: Option<(&'static str, String)>,
    error: Option<Error>,
}

/// A recorder's checkpoint between two episodes, in addition to the files on disk.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RecorderMemory {
    mode: RecordMode,
    /// Messages in `run.mcap`.
    messages: u64,
    /// The episodes whose files are kept, with their sizes in bytes.
    kept: Vec<(u32, u64)>,
    clock_ns: u64,
    event_logger: (Curve, bool),
}

impl RecorderMemory {
    /// Creates the checkpoint of a recorder that has not recorded anything.
    pub fn new(mode: RecordMode) -> Self {
        Self {
            mode,
            ..Self::default()
        }
    }
}

/// The files that a recorder has written.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RecordSummary {
    /// The recordings, episodes first, `run.mcap` last.
    pub files: Vec<PathBuf>,
    /// The total size in bytes.
    pub bytes: u64,
}

impl Recorder {
    /// Creates `folder` if it is missing, writes both layouts and begins `run.mcap`. Older files of
    /// these names are replaced. With [`RecordMode::None`] nothing is written.
    ///
    /// # Errors
    /// If the folder or a file in it cannot be created.
    pub fn create(
        folder: &Path,
        maze: &Maze,
        info: RunInfo,
        mode: RecordMode,
    ) -> Result<Self, Error> {
        let mut recorder = Self::new(folder, maze, info, RecorderMemory::new(mode));
        if mode != RecordMode::None {
            recorder.lay_out()?;
            recorder.outbox.run = Some(recorder.open_run("part")?);
        }
        Ok(recorder)
    }

    /// Continues from a recorder's checkpoint; `learned` is the policy learned in the earlier
    /// episodes. Later messages of `run.mcap.part` are discarded, because their episodes will be
    /// run again.
    ///
    /// # Errors
    /// If `run.mcap.part` is missing, damaged or too short, or a file cannot be created.
    pub fn resume(
        folder: &Path,
        maze: &Maze,
        info: RunInfo,
        memory: RecorderMemory,
        learned: PolicyMap,
    ) -> Result<Self, Error> {
        if memory.mode == RecordMode::None || memory.messages == 0 {
            return Self::create(folder, maze, info, memory.mode);
        }
        let (messages, logged) = (memory.messages, memory.event_logger.clone());
        let mut recorder = Self::new(folder, maze, info, memory);
        recorder.lay_out()?;
        recorder.outbox.run = Some(recorder.rebuilt_run(messages)?);
        recorder.event_logger.resume(logged, learned, maze);
        Ok(recorder)
    }

    /// Rebuilds `run.mcap.part` with its first `messages` messages. If the run was stopped in its
    /// last steps, the file may already have its final name.
    fn rebuilt_run(&self, messages: u64) -> Result<OpenFile, Error> {
        let whole = self.path(RecordingKind::Run);
        let part = disk::part(&whole);
        let is_whole = whole.exists() && !part.exists();
        let source = if is_whole { whole } else { part };
        // Check this first, so that a missing recording leaves the folder unchanged.
        let opened = disk::open(&source).map(drop);
        opened.map_err(disk::cannot_read(&source))?;
        // Write a separate file, so that nothing is lost if this is stopped, too.
        let mut run = self.open_run("again")?;
        rebuild::copy(&source, messages, &mut run)?;
        run.become_part()?;
        Ok(run)
    }

    fn new(folder: &Path, maze: &Maze, info: RunInfo, memory: RecorderMemory) -> Self {
        Self {
            folder: folder.to_owned(),
            world: maze.name().to_owned(),
            layouts: [layout::of_episode(maze), layout::of_run(maze)],
            event_logger: EventLogger::new(maze, &info, memory.mode == RecordMode::Beams),
            info,
            outbox: Outbox::default(),
            memory,
            attached: None,
            error: None,
        }
    }

    /// Shows a policy that was learned elsewhere from the start.
    pub fn warm_start(&mut self, method: &dyn Agent, maze: &Maze) {
        self.event_logger.warm_start(method, self.info.sensor, maze);
    }

    /// Returns the recording mode.
    pub fn mode(&self) -> RecordMode {
        self.memory.mode
    }

    /// Returns the checkpoint after the last episode, and syncs the recordings so far to disk.
    ///
    /// # Errors
    /// The first error of the whole recording.
    pub fn memory(&mut self) -> Result<RecorderMemory, Error> {
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        let run = self.outbox.run.as_ref();
        run.map_or(Ok(()), OpenFile::sync)?;
        Ok(RecorderMemory {
            messages: run.map_or(0, OpenFile::messages),
            event_logger: self.event_logger.memory(),
            ..self.memory.clone()
        })
    }

    /// Attaches a text to `run.mcap` when it is finished.
    pub(crate) fn attach(&mut self, name: &'static str, text: String) {
        self.attached = Some((name, text));
    }

    /// Finishes `run.mcap` with the final rules of `method`.
    ///
    /// # Errors
    /// The first error of the whole recording. Unfinished files keep the extension `.part`.
    pub fn finish(mut self, method: &dyn Agent) -> Result<RecordSummary, Error> {
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        let kept = self.memory.kept.iter();
        let mut files: Vec<_> = kept
            .map(|&(episode, bytes)| (self.path(RecordingKind::Episode(episode)), bytes))
            .collect();
        if let Some(mut run) = self.outbox.run.take() {
            run.with(|log| self.attach_results(log, &rules_json(method)))?;
            files.push(run.finish()?);
        }
        Ok(RecordSummary {
            bytes: files.iter().map(|(_, bytes)| bytes).sum(),
            files: files.into_iter().map(|(path, _)| path).collect(),
        })
    }

    /// Attaches the final rules, and the additional text.
    fn attach_results<W: Write>(&self, log: &mut LogFile<W>, rules: &str) -> McapResult<()> {
        log.attach("rules.json", self.memory.clock_ns, rules)?;
        match &self.attached {
            Some((name, text)) => log.attach(name, self.memory.clock_ns, text),
            None => Ok(()),
        }
    }

    fn path(&self, kind: RecordingKind) -> PathBuf {
        self.folder.join(kind.file_name())
    }

    /// Creates the folder and writes both layouts.
    fn lay_out(&self) -> Result<(), Error> {
        fs::create_dir_all(&self.folder).map_err(disk::cannot_create(&self.folder))?;
        let names = ["foxglove-layout.json", "foxglove-layout-run.json"];
        for (name, text) in names.into_iter().zip(&self.layouts) {
            let path = self.folder.join(name);
            disk::replace(&path, text.as_bytes()).map_err(disk::cannot_create(&path))?;
        }
        Ok(())
    }

    fn open_run(&self, extension: &str) -> Result<OpenFile, Error> {
        let name = RecordingKind::Run.file_name();
        let file = OpenFile::create(&self.folder, &name, extension)?;
        self.introduce(file, RecordingKind::Run, &Topic::of_run())
    }

    /// Begins a file with the facts of the run and its topics.
    fn introduce(
        &self,
        mut file: OpenFile,
        kind: RecordingKind,
        topics: &[Topic],
    ) -> Result<OpenFile, Error> {
        let facts = Facts {
            info: &self.info,
            world: &self.world,
            mode: self.memory.mode,
            kind,
        };
        file.with(|log| {
            log.facts(&facts, self.memory.clock_ns)?;
            if kind == RecordingKind::Run {
                let [_, layout] = &self.layouts;
                log.attach("foxglove-layout.json", self.memory.clock_ns, layout)?;
            }
            log.declare(topics)
        })?;
        Ok(file)
    }

    fn begin(&mut self, episode: u32, view: &View<'_>) -> Result<(), Error> {
        self.memory.clock_ns = view.now().time_ns;
        if self.memory.mode.wants(episode) {
            let kind = RecordingKind::Episode(episode);
            let beams = self.memory.mode == RecordMode::Beams;
            let name = kind.file_name();
            let file = OpenFile::create(&self.folder, &name, "part")?;
            let topics = Topic::of_episode(view.sensed.is_some(), beams);
            self.outbox.episode = Some(self.introduce(file, kind, &topics)?);
        }
        self.event_logger.began(&mut self.outbox, episode, view)
    }

    fn end(&mut self, episode: &Episode, learned: &Learned<'_>) -> Result<(), Error> {
        self.memory.clock_ns = learned.view.now().time_ns;
        self.event_logger
            .ended(&mut self.outbox, episode, learned)?;
        if let Some(run) = &mut self.outbox.run {
            run.with(|log| log.flush())?;
        }
        if let Some(file) = self.outbox.episode.take() {
            let (_, bytes) = file.finish()?;
            self.memory.kept.push((episode.episode, bytes));
        }
        Ok(())
    }

    /// Runs an action unless there was an error; stores the first error.
    fn attempt(&mut self, act: impl FnOnce(&mut Self) -> Result<(), Error>) {
        if self.error.is_none() && self.memory.mode != RecordMode::None {
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

/// Returns the learner's knowledge as the text of `rules.json`.
fn rules_json(method: &dyn Agent) -> String {
    serde_json::to_string(&method.knowledge()).expect("knowledge is plain data")
}
