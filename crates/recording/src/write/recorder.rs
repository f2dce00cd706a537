//! Creates, keeps and deletes the files of a recording.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::event_source::{EventSource, Timed};
use super::file::File;
use super::stream::{MessageStream, Scenery};
use crate::disk;
use crate::error::Error;
use crate::info::{RecordingKind, RunInfo};
use crate::layout;
use crate::mode::RecordMode;
use crate::topics::Topic;
use xcscr_learner::agent::Agent;
use xcscr_learner::episode::{AfterEpisode, Episode, Observer, Step};
use xcscr_robot::arena::View;
use xcscr_robot::world::Maze;

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
    events: EventSource,
    scenery: Arc<Scenery>,
    run: Option<MessageStream>,
    episode: Option<MessageStream>,
    mode: RecordMode,
    /// True if complete files of episodes are compared and not replaced.
    repeats: bool,
    /// The episodes whose files are kept, with their sizes in bytes.
    kept: Vec<(u32, u64)>,
    clock_ns: u64,
    /// Name and text of an additional attachment of `run.mcap`.
    attached: Option<(&'static str, String)>,
    error: Option<Error>,
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
        Self::new(folder, maze, info, mode).begun()
    }

    /// Like [`create`](Self::create) for a run that is repeated, whose complete files of episodes
    /// stay as they are. A difference between such a file and what is recorded now is an error.
    ///
    /// # Errors
    /// If the folder or a file in it cannot be created.
    pub fn repeat(
        folder: &Path,
        maze: &Maze,
        info: RunInfo,
        mode: RecordMode,
    ) -> Result<Self, Error> {
        let mut recorder = Self::new(folder, maze, info, mode);
        recorder.repeats = true;
        recorder.begun()
    }

    fn begun(mut self) -> Result<Self, Error> {
        if self.mode != RecordMode::None {
            self.lay_out()?;
            self.run = Some(self.open_run()?);
        }
        Ok(self)
    }

    fn new(folder: &Path, maze: &Maze, info: RunInfo, mode: RecordMode) -> Self {
        Self {
            folder: folder.to_owned(),
            world: maze.name().to_owned(),
            layouts: [layout::of_episode(maze), layout::of_run(maze)],
            events: EventSource::new(maze, &info, mode == RecordMode::Beams),
            scenery: Arc::new(Scenery::new(maze, &info)),
            info,
            run: None,
            episode: None,
            mode,
            repeats: false,
            kept: Vec::new(),
            clock_ns: 0,
            attached: None,
            error: None,
        }
    }

    /// Shows a policy that was learned elsewhere from the start.
    pub fn warm_start(&mut self, method: &dyn Agent, maze: &Maze) {
        self.events.warm_start(method, maze);
    }

    /// Returns the recording mode.
    pub fn mode(&self) -> RecordMode {
        self.mode
    }

    /// Returns the first error of the whole recording so far.
    ///
    /// # Errors
    /// That error.
    pub fn check(&self) -> Result<(), Error> {
        self.error.clone().map_or(Ok(()), Err)
    }

    /// Makes the whole recording fail with this error, unless it has failed before.
    pub fn fail(&mut self, error: Error) {
        self.error.get_or_insert(error);
    }

    /// Attaches a text to `run.mcap` when it is finished.
    pub fn attach(&mut self, name: &'static str, text: String) {
        self.attached = Some((name, text));
    }

    /// Finishes `run.mcap` with the final rules of `method`.
    ///
    /// # Errors
    /// The first error of the whole recording. Unfinished files keep the extension `.part`.
    pub fn finish(mut self, method: &dyn Agent) -> Result<RecordSummary, Error> {
        self.check()?;
        let kept = self.kept.iter();
        let mut files: Vec<_> = kept
            .map(|&(episode, bytes)| (self.path(RecordingKind::Episode(episode)), bytes))
            .collect();
        if let Some(run) = self.run.take() {
            let mut run = run.into_file();
            run.attach("rules.json", self.clock_ns, &rules_json(method))?;
            if let Some((name, text)) = &self.attached {
                run.attach(name, self.clock_ns, text)?;
            }
            files.push(run.finish()?);
        }
        Ok(RecordSummary {
            bytes: files.iter().map(|(_, bytes)| bytes).sum(),
            files: files.into_iter().map(|(path, _)| path).collect(),
        })
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

    fn open_run(&self) -> Result<MessageStream, Error> {
        let kind = RecordingKind::Run;
        let file = File::create(self.path(kind))?;
        self.introduce(file, kind, &Topic::of_run())
    }

    fn open_episode(&self, episode: u32, view: &View<'_>) -> Result<MessageStream, Error> {
        let kind = RecordingKind::Episode(episode);
        let path = self.path(kind);
        let file = if self.repeats && path.is_file() {
            File::complete(path)
        } else {
            File::create(path)
        };
        let beams = self.mode == RecordMode::Beams;
        self.introduce(
            file?,
            kind,
            &Topic::of_episode(view.sensed.is_some(), beams),
        )
    }

    /// Begins a file with the facts of the run and its topics.
    fn introduce(
        &self,
        mut file: File,
        kind: RecordingKind,
        topics: &[Topic],
    ) -> Result<MessageStream, Error> {
        let (info, time_ns) = (&self.info, self.clock_ns);
        file.metadata("run", info.metadata(&self.world, self.mode, kind))?;
        file.attach("world.json", time_ns, &info.world_json)?;
        file.attach("config.json", time_ns, &info.config_json)?;
        if kind == RecordingKind::Run {
            let [_, layout] = &self.layouts;
            file.attach("foxglove-layout.json", time_ns, layout)?;
        }
        file.declare(topics)?;
        Ok(MessageStream::new(file, kind, Arc::clone(&self.scenery)))
    }

    fn begin(&mut self, episode: u32, view: &View<'_>) -> Result<(), Error> {
        self.clock_ns = view.now().time_ns;
        if self.mode.wants(episode) {
            self.episode = Some(self.open_episode(episode, view)?);
        }
        let events = self.events.began(episode, view);
        self.write(&events)
    }

    fn step(&mut self, step: &Step<'_>) -> Result<(), Error> {
        let events = self.events.stepped(step, self.episode.is_some());
        self.write(&events)
    }

    fn end(&mut self, episode: &Episode, after: &AfterEpisode<'_>) -> Result<(), Error> {
        self.clock_ns = after.view.now().time_ns;
        let events = self.events.ended(episode, after);
        self.write(&events)?;
        if let Some(stream) = self.episode.take() {
            let (_, bytes) = stream.into_file().finish()?;
            self.kept.push((episode.episode, bytes));
        }
        Ok(())
    }

    fn write(&mut self, events: &[Timed]) -> Result<(), Error> {
        let streams = [&mut self.episode, &mut self.run].into_iter().flatten();
        for stream in streams {
            for (time_ns, event) in events {
                stream.write(*time_ns, event)?;
            }
        }
        Ok(())
    }

    /// Runs an action unless there was an error; stores the first error.
    fn attempt(&mut self, act: impl FnOnce(&mut Self) -> Result<(), Error>) {
        if self.error.is_none() && self.mode != RecordMode::None {
            self.error = act(self).err();
        }
    }
}

impl Observer for Recorder {
    fn began(&mut self, episode: u32, view: &View<'_>) {
        self.attempt(|recorder| recorder.begin(episode, view));
    }

    fn stepped(&mut self, step: &Step<'_>) {
        self.attempt(|recorder| recorder.step(step));
    }

    fn ended(&mut self, episode: &Episode, after: &AfterEpisode<'_>) -> ControlFlow<()> {
        self.attempt(|recorder| recorder.end(episode, after));
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
