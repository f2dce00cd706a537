//! The run that a recording comes from.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use super::error;
use super::external::{EXTERNAL_EPISODES, ExternalEpisode, METHOD};
use super::run_inputs::RunInputs;
use crate::Error;
use crate::agent::Knowledge;
use crate::episode::{AfterEpisode, Episode, Observer};
use crate::record::reader::Recording;
use crate::record::{RecordMode, RecordModeError, RecordingKind, RunKind};
use crate::trial::Plan;
use crate::world::Maze;

/// The run of a recording, according to the recording.
pub struct RecordedRun {
    /// The recording.
    pub file: PathBuf,
    /// What determines its episodes.
    pub run: RunInputs,
    /// The recording mode.
    pub mode: RecordMode,
    /// The kind of the recording.
    pub extent: RecordingKind,
    /// The bytes of the whole file.
    pub bytes: Vec<u8>,
}

impl RecordedRun {
    /// Reads a recording.
    ///
    /// # Errors
    /// If the file cannot be read, or does not contain the facts of its run.
    pub fn of(file: &Path) -> Result<Self, Error> {
        Self::of_recording(&Recording::open(file)?)
    }

    /// Returns the run of a recording that was read.
    ///
    /// # Errors
    /// If the recording does not contain the facts of its run, or those of several.
    pub fn of_recording(recording: &Recording) -> Result<Self, Error> {
        recording.require_single()?;
        let file = recording.path();
        let metadata = recording.metadata("run");
        let entry = |key: &str| metadata.and_then(|m| m.get(key)).map_or("", String::as_str);
        let extent = RecordingKind::of_entry(entry("episode"));
        let kind = recording.run_kind()?;
        let external = match kind {
            RunKind::Training => None,
            RunKind::External => Some(external_episodes(file, recording)?),
            RunKind::Evaluation => {
                let fault =
                    "it shows a drive of a policy, which is part of a page and cannot be repeated";
                return Err(error::recording(file, fault));
            }
        };
        let run = RunInputs {
            plan: attached_plan(recording)?,
            external,
        };
        Ok(Self {
            file: file.to_owned(),
            run,
            mode: recorded_mode(recording)?,
            extent,
            bytes: recording.bytes().to_vec(),
        })
    }
}

impl RecordedRun {
    /// Returns the name of the method, or `external`.
    pub fn method_name(&self) -> &'static str {
        match self.run.external {
            None => self.run.plan.config.method.name(),
            Some(_) => METHOD,
        }
    }

    /// Requires the recording of a method of this program.
    ///
    /// # Errors
    /// If an external agent chose the actions.
    pub fn require_method(&self) -> Result<(), Error> {
        match self.run.external {
            None => Ok(()),
            Some(_) => Err(error::recording(
                &self.file,
                "an external agent chose its actions, and its policy is not recorded; give a run of `xcscr train`",
            )),
        }
    }

    /// Repeats the training up to the end of the recording, and returns the knowledge.
    ///
    /// # Errors
    /// If the plan of the recording cannot be run, or an external agent chose the actions.
    pub fn knowledge(&self) -> Result<Knowledge, Error> {
        self.require_method()?;
        self.run.watch(&mut Last(self.extent.episode()))
    }
}

/// Ends a run after an episode; `None` never does.
struct Last(Option<u32>);

impl Observer for Last {
    fn ended(&mut self, episode: &Episode, _: &AfterEpisode<'_>) -> ControlFlow<()> {
        if self.0 == Some(episode.episode) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// Returns the recording mode from the metadata of a recording.
fn recorded_mode(recording: &Recording) -> Result<RecordMode, Error> {
    let entry = recording.metadata("run").and_then(|m| m.get("record"));
    let mode = entry.map_or("", String::as_str).parse();
    mode.map_err(|fault: RecordModeError| error::recording(recording.path(), fault))
}

/// Returns the plan whose world and settings are attached to a recording.
fn attached_plan(recording: &Recording) -> Result<Plan, Error> {
    let damaged = |fault: String| error::recording(recording.path(), fault);
    let attached = |name: &str| {
        let missing = || damaged(format!("the attachment {name} is missing"));
        recording.attachment(name).ok_or_else(missing)
    };
    let config = serde_json::from_slice(attached("config.json")?)
        .map_err(|fault| damaged(format!("config.json: {fault}")))?;
    let maze = Maze::from_json(attached("world.json")?, "world.json")?;
    Ok(Plan { maze, config })
}

/// Returns the episodes of an external agent, which are attached to `run.mcap` next to the episodes.
fn external_episodes(file: &Path, recording: &Recording) -> Result<Vec<ExternalEpisode>, Error> {
    let name = EXTERNAL_EPISODES;
    let beside = file.with_file_name(RecordingKind::Run.file_name());
    let attached = match recording.attachment(name) {
        Some(text) => Some(text.to_owned()),
        None => {
            let run = Recording::open(&beside).ok();
            run.and_then(|run| run.attachment(name).map(<[u8]>::to_owned))
        }
    };
    let damaged = |fault: String| error::recording(file, fault);
    let text = attached.ok_or_else(|| {
        let beside = beside.display();
        damaged(format!(
            "its {name} is attached to {beside}, which cannot be read"
        ))
    })?;
    serde_json::from_slice(&text).map_err(|fault| damaged(format!("{name}: {fault}")))
}
