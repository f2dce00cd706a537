//! Which files there are, and when they are made, kept and given up.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use super::channels::Topic;
use super::error::RecordError;
use super::info::RunInfo;
use super::layout;
use super::log_file::OpenFile;
use super::mode::RecordMode;
use super::outbox::Outbox;
use super::scribe::Scribe;
use crate::arena::View;
use crate::episode::{Ending, Episode, Learned, Observer, Step};
use crate::reward::RewardMethod;
use crate::world::Maze;

/// The file of the whole run.
const RUN_FILE: &str = "run.mcap";

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
    layout: String,
    scribe: Scribe,
    outbox: Outbox,
    /// The files that are whole, with their sizes in bytes.
    kept: Vec<(PathBuf, u64)>,
    /// Steps of the episode that is the best so far.
    best: Option<u32>,
    clock_ns: u64,
    error: Option<RecordError>,
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
        let mut recorder = Self {
            folder: folder.to_owned(),
            mode,
            world: maze.name().to_owned(),
            layout: layout::of_episode(maze),
            scribe: Scribe::new(maze, info.robot),
            info,
            outbox: Outbox::default(),
            kept: Vec::new(),
            best: None,
            clock_ns: 0,
            error: None,
        };
        if mode != RecordMode::None {
            recorder.open_run(maze)?;
        }
        Ok(recorder)
    }

    /// Finishes `run.mcap` with the rules that `method` ended with.
    ///
    /// # Errors
    /// The first error of the whole recording; unfinished files are kept as `.part`.
    pub fn finish(mut self, method: &dyn RewardMethod) -> Result<RecordSummary, RecordError> {
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        if let Some(mut run) = self.outbox.run.take() {
            let rules = rules_json(method);
            run.with(|log| log.attach("rules.json", self.clock_ns, &rules))?;
            self.kept.push(run.finish()?);
        }
        Ok(RecordSummary {
            bytes: self.kept.iter().map(|(_, bytes)| bytes).sum(),
            files: self.kept.into_iter().map(|(path, _)| path).collect(),
        })
    }

    fn open_run(&mut self, maze: &Maze) -> Result<(), RecordError> {
        let layout = layout::of_run(maze);
        fs::create_dir_all(&self.folder).map_err(|cause| RecordError::Create {
            path: self.folder.clone(),
            cause,
        })?;
        for (name, text) in [
            ("foxglove-layout.json", &self.layout),
            ("foxglove-layout-run.json", &layout),
        ] {
            let path = self.folder.join(name);
            fs::write(&path, text).map_err(|cause| RecordError::Create { path, cause })?;
        }
        self.outbox.run = Some(self.open(RUN_FILE, None, &layout, &Topic::OF_RUN)?);
        Ok(())
    }

    /// Begins a file with the facts of the run and its topics.
    fn open(
        &self,
        name: &str,
        episode: Option<u32>,
        layout: &str,
        topics: &[Topic],
    ) -> Result<OpenFile, RecordError> {
        let mut file = OpenFile::create(&self.folder, name)?;
        file.with(|log| {
            log.metadata("run", self.info.metadata(&self.world, self.mode, episode))?;
            log.attach("world.json", self.clock_ns, &self.info.world_json)?;
            log.attach("config.json", self.clock_ns, &self.info.config_json)?;
            if episode.is_none() {
                log.attach("foxglove-layout.json", self.clock_ns, layout)?;
            }
            log.declare(topics)
        })?;
        Ok(file)
    }

    fn begin(&mut self, episode: u32, view: &View<'_>) -> Result<(), RecordError> {
        self.clock_ns = view.now().time_ns;
        if self.mode.wants(episode) {
            let name = format!("ep-{episode:04}.mcap");
            let file = self.open(&name, Some(episode), &self.layout, &Topic::ALL)?;
            self.outbox.episode = Some(file);
        }
        self.scribe.began(&mut self.outbox, episode, view)
    }

    fn end(&mut self, episode: &Episode, learned: &Learned<'_>) -> Result<(), RecordError> {
        self.clock_ns = learned.view.now().time_ns;
        self.scribe.ended(&mut self.outbox, episode, learned)?;
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
        method: &dyn RewardMethod,
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
        let whole = file.finish()?;
        if matches!(self.mode, RecordMode::Best | RecordMode::Last) {
            self.drop_kept()?;
        }
        self.kept.push(whole);
        Ok(())
    }

    fn drop_kept(&mut self) -> Result<(), RecordError> {
        for (path, _) in self.kept.drain(..) {
            fs::remove_file(&path).map_err(|cause| RecordError::Write {
                path,
                cause: cause.to_string(),
            })?;
        }
        Ok(())
    }

    /// Does something unless there was an error before; keeps the first one.
    fn attempt(&mut self, act: impl FnOnce(&mut Self) -> Result<(), RecordError>) {
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
        self.attempt(|recorder| recorder.scribe.stepped(&mut recorder.outbox, step));
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
fn rules_json(method: &dyn RewardMethod) -> String {
    serde_json::to_string(&method.knowledge()).expect("knowledge is plain data")
}
