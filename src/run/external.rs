//! Recorded episodes of an external agent.
//!
//! The agent is not part of this program, so the recording cannot be repeated by learning again. Seeds, start cells
//! and actions determine the episodes. `run.mcap` carries them as an attachment, and verifying a recording repeats
//! them in the same arena.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error::{self, RunError};
use super::facts::run_info;
use crate::agent::{Agent, Choice, Chooser, EndCredit, Explorer, Knowledge, StepCredit};
use crate::arena::{Lasting, Outcome, Sample};
use crate::episode;
use crate::record::{RecordMode, RecordSummary, Recorder, RunInfo, RunKind};
use crate::streams::StreamName;
use crate::trial::Plan;
use crate::world::Cell;
use xcs::random::Stream;
use xcs::{Action, Percept, PredictionArray};

/// The attachment of `run.mcap` with the episodes.
pub(super) const EXTERNAL_EPISODES: &str = "external-episodes.json";
/// The name of the method in the metadata of the recording.
pub(super) const METHOD: &str = "external";

/// An episode of an external agent.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExternalEpisode {
    /// The seed of the arena's noise in this episode.
    pub seed: u64,
    /// The column and the row of the start cell.
    pub start: (u16, u16),
    /// The actions, numbered clockwise from north.
    pub actions: Vec<usize>,
    /// The reward of each action, as the agent received it.
    pub rewards: Vec<f64>,
}

/// Records episodes of an external agent. Each episode is repeated in an arena of its own, which an observer records.
pub struct ExternalRecorder {
    plan: Plan,
    folder: PathBuf,
    recorder: Recorder,
    episodes: Vec<ExternalEpisode>,
    clock_ns: u64,
}

impl ExternalRecorder {
    /// Begins a recording in `folder`, which must be missing or empty.
    ///
    /// # Errors
    /// If the plan is invalid, the folder contains files, or a file cannot be written.
    pub fn create(folder: &Path, plan: &Plan, mode: RecordMode) -> Result<Self, RunError> {
        let plan = plan.clone().settled();
        plan.check()?;
        require_empty(folder)?;
        let info = RunInfo {
            kind: RunKind::External,
            method: METHOD.to_owned(),
            ..run_info(&plan)
        };
        Ok(Self {
            recorder: Recorder::create(folder, &plan.maze, info, mode)?,
            folder: folder.to_owned(),
            episodes: Vec::new(),
            clock_ns: 0,
            plan,
        })
    }

    /// Repeats an episode and records it. Returns the robot's state at the end.
    ///
    /// # Errors
    /// If the episode is impossible in this world, or a file cannot be written.
    pub fn record(&mut self, episode: ExternalEpisode) -> Result<Sample, RunError> {
        let number = self.episodes.len() + 1;
        let fault =
            |fault: String| error::recording(&self.folder, format!("episode {number}: {fault}"));
        self.check(&episode).map_err(fault)?;
        let Plan { maze, config } = &self.plan;
        let mut config = config.clone();
        config.seed = episode.seed;
        let mut arena = config.build_arena(maze)?;
        // The times of a recording increase across episodes. The lidar is where it was at time 0.
        let lasting = Lasting {
            time_ns: self.clock_ns,
            ..arena.lasting()
        };
        arena.continue_from(&lasting);
        let mut explorer = Explorer::new(0.0, Stream::new(0, StreamName::Exploration));
        let mut script = Script::new(&episode, maze.action_count());
        let (col, row) = episode.start;
        let (done, flow) = episode::run(
            u32::try_from(number).unwrap_or(u32::MAX),
            Cell { col, row },
            &mut *arena,
            config.sensor,
            &mut script,
            &mut explorer,
            &mut self.recorder,
        );
        let end = arena.view().now();
        self.clock_ns = end.time_ns.next_multiple_of(lidar_cycle_ns(&self.plan));
        if flow.is_break() {
            // The recorder has failed, and returns its error.
            self.recorder.memory()?;
        }
        if done.steps as usize != episode.actions.len() {
            let steps = done.steps;
            return Err(fault(format!(
                "the robot is at the goal after {steps} steps, but there are more actions"
            )));
        }
        self.episodes.push(episode);
        Ok(end)
    }

    /// Checks that an episode can be repeated.
    fn check(&self, episode: &ExternalEpisode) -> Result<(), String> {
        let maze = &self.plan.maze;
        let (col, row) = episode.start;
        let is_inside = col < maze.width() && row < maze.height();
        if !is_inside || maze.is_wall(Cell { col, row }) {
            return Err(format!("the start ({col}, {row}) is not a free cell"));
        }
        let count = episode.actions.len();
        if count == 0 || count != episode.rewards.len() || u32::try_from(count).is_err() {
            return Err("it must have actions, and as many rewards".to_owned());
        }
        if let Some(action) = episode
            .actions
            .iter()
            .find(|&&one| one >= maze.action_count())
        {
            return Err(format!("there is no action {action}"));
        }
        match episode.rewards.iter().all(|reward| reward.is_finite()) {
            true => Ok(()),
            false => Err("a reward is not a finite number".to_owned()),
        }
    }

    /// Finishes the recording.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn finish(mut self) -> Result<RecordSummary, RunError> {
        let text = serde_json::to_string(&self.episodes).expect("plain data becomes JSON");
        self.recorder.attach(EXTERNAL_EPISODES, text);
        let nothing = ExternalEpisode::default();
        let script = Script::new(&nothing, self.plan.maze.action_count());
        self.recorder.finish(&script)
    }
}

/// Records episodes again. Returns what the recording says was learned, which is nothing.
pub(super) fn record_external(
    plan: &Plan,
    episodes: &[ExternalEpisode],
    folder: &Path,
    mode: RecordMode,
) -> Result<Knowledge, RunError> {
    let mut recorder = ExternalRecorder::create(folder, plan, mode)?;
    for episode in episodes {
        recorder.record(episode.clone())?;
    }
    recorder.finish()?;
    Ok(Knowledge::Table(BTreeMap::new()))
}

/// Returns the time after which the lidar sends the same beams again: the arena's steps have 50 ms, and the rate of the
/// lidar is counted in millionths of a hertz. The agent's episodes all began at time 0.
fn lidar_cycle_ns(plan: &Plan) -> u64 {
    const STEP_NS: u64 = 50_000_000;
    const STEPS_PER_S: u64 = 20;
    const PER_HZ: u64 = 1_000_000;
    let rate = plan.config.settings.physics.lidar.rate_hz;
    let turns = (rate * PER_HZ as f64).round() as u64;
    let (mut common, mut rest) = (STEPS_PER_S * PER_HZ, turns);
    while rest > 0 {
        (common, rest) = (rest, common % rest);
    }
    STEPS_PER_S * PER_HZ / common * STEP_NS
}

fn require_empty(folder: &Path) -> Result<(), RunError> {
    let fault = |fault: String| error::recording(folder, fault);
    match fs::read_dir(folder) {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(cause) => Err(fault(cause.to_string())),
        Ok(mut entries) => match entries.next() {
            None => Ok(()),
            Some(_) => Err(fault(
                "the folder contains files: choose another one".to_owned(),
            )),
        },
    }
}

/// Repeats the actions and the rewards of an episode.
struct Script<'a> {
    episode: &'a ExternalEpisode,
    actions: usize,
    step: usize,
}

impl<'a> Script<'a> {
    fn new(episode: &'a ExternalEpisode, actions: usize) -> Self {
        Self {
            episode,
            actions,
            step: 0,
        }
    }
}

impl Agent for Script<'_> {
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.values(percept)
    }

    fn choose(&mut self, _: &PredictionArray, _: &mut Explorer) -> Choice {
        let action = Action::new(self.episode.actions[self.step]);
        Choice::new(action.expect("actions are checked"), Chooser::Table)
    }

    fn update(&mut self, _: Action, _: Outcome) -> StepCredit {
        self.step += 1;
        StepCredit {
            short_term_reward: self.episode.rewards[self.step - 1],
            ..StepCredit::default()
        }
    }

    fn end_episode(&mut self, _: bool) -> EndCredit {
        EndCredit {
            long_term_reward: 0.0,
            learning_rate: 0.0,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        u32::try_from(self.episode.actions.len()).unwrap_or(u32::MAX)
    }

    fn values(&self, _: &Percept) -> PredictionArray {
        PredictionArray::new(self.actions)
    }

    fn knowledge(&self) -> Knowledge {
        Knowledge::Table(BTreeMap::new())
    }

    fn rule_count(&self) -> usize {
        0
    }
}
