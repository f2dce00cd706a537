//! Recorded episodes of an external agent.
//!
//! The agent is not part of this program, so the recording cannot be repeated by learning again. Seeds, start cells
//! and actions determine the episodes. `run.mcap` carries them as an attachment, and verifying a recording repeats
//! them in the same arena.

mod script;

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error;
use super::facts::run_info;
use crate::Error;
use crate::agent::{Explorer, Knowledge};
use crate::arena::{Arena, ArenaKind, Robot, Sample, WheelDrive};
use crate::episode::{self, Start};
use crate::record::{RecordMode, RecordSummary, Recorder, RunInfo, RunKind};
use crate::streams::StreamName;
use crate::trial::Plan;
use crate::world::Cell;
use script::{Script, ScriptedWheels};
use xcs::random::Stream;
use xcscr_sensing::STEP_NS;

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
    /// What the agent did.
    pub actions: ExternalActions,
    /// The reward of each action, as the agent received it.
    pub rewards: Vec<f64>,
}

/// The actions of an episode. In JSON, moves are a list, and wheel speeds an object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ExternalActions {
    /// Moves from cell to cell, numbered clockwise from north.
    Moves(Vec<usize>),
    /// Speeds of the wheels. They require the arena `physics`, and a robot that does not estimate its
    /// pose.
    Wheels(WheelSpeeds),
}

/// The speeds of the wheels of an episode, one pair for each step of 50 ms.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WheelSpeeds {
    /// The heading at the start in radians, counter-clockwise from the grid's x axis.
    pub heading_rad: f64,
    /// The commanded speeds of the left and right rim, in m/s.
    pub speeds_mps: Vec<[f64; 2]>,
}

impl Default for ExternalActions {
    fn default() -> Self {
        Self::Moves(Vec::new())
    }
}

impl ExternalActions {
    /// Returns the number of actions.
    pub fn len(&self) -> usize {
        match self {
            Self::Moves(moves) => moves.len(),
            Self::Wheels(wheels) => wheels.speeds_mps.len(),
        }
    }

    /// Returns true if there are no actions.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the first reason why they are impossible in the world of a plan.
    fn fault(&self, plan: &Plan) -> Option<String> {
        let count = plan.maze.action_count();
        match self {
            Self::Moves(moves) => {
                let unknown = moves.iter().find(|&&one| one >= count)?;
                Some(format!("there is no action {unknown}"))
            }
            Self::Wheels(_) if plan.config.arena != ArenaKind::Physics => {
                Some("wheel speeds need the arena `physics`".to_owned())
            }
            Self::Wheels(_) if plan.config.senses() => {
                let fault = "wheel speeds need a robot that does not estimate its pose";
                Some(format!("{fault}: choose the sensor `neighbours`"))
            }
            Self::Wheels(wheels) => {
                let speeds = wheels.speeds_mps.iter().flatten();
                let finite = speeds.chain([&wheels.heading_rad]).all(|n| n.is_finite());
                (!finite).then(|| "a speed or the heading is not a finite number".to_owned())
            }
        }
    }
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
    pub fn create(folder: &Path, plan: &Plan, mode: RecordMode) -> Result<Self, Error> {
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
    /// If the episode is impossible in this world, or a file cannot be written. If the robot reaches
    /// the goal before the last action, the whole recording fails.
    pub fn record(&mut self, episode: ExternalEpisode) -> Result<Sample, Error> {
        let number = self.episodes.len() + 1;
        let fault =
            |fault: String| error::recording(&self.folder, format!("episode {number}: {fault}"));
        self.check(&episode).map_err(fault)?;
        let maze = &self.plan.maze;
        let mut arena = self.arena(&episode)?;
        // The times of a recording increase across episodes. The lidar is where it was at time 0.
        arena.set_clock(self.clock_ns);
        let mut explorer = Explorer::new(0.0, Stream::new(0, StreamName::Exploration));
        let mut script = Script::new(&episode, maze.action_count());
        let (col, row) = episode.start;
        let start = Start {
            episode: u32::try_from(number).unwrap_or(u32::MAX),
            cell: Cell { col, row },
            evolves: false,
        };
        let (done, flow) = episode::run(
            start,
            &mut *arena,
            self.plan.config.sensor,
            &mut script,
            &mut explorer,
            &mut self.recorder,
        );
        let end = arena.view().now();
        self.clock_ns = end.time_ns.next_multiple_of(lidar_cycle_ns(&self.plan));
        if flow.is_break() {
            // The recorder has failed, and returns its error.
            self.recorder.check()?;
        }
        if done.steps as usize != episode.actions.len() {
            let steps = done.steps;
            let error = fault(format!(
                "the robot is at the goal after {steps} steps, but there are more actions"
            ));
            // The episode is already in the recording, which would not be that of the others.
            self.recorder.fail(error.clone());
            return Err(error);
        }
        self.episodes.push(episode);
        Ok(end)
    }

    /// Builds the arena of an episode.
    fn arena(&self, episode: &ExternalEpisode) -> Result<Box<dyn Arena>, Error> {
        let Plan { maze, config } = &self.plan;
        let mut config = config.clone();
        config.seed = episode.seed;
        let ExternalActions::Wheels(wheels) = &episode.actions else {
            return Ok(config.build_arena(maze)?);
        };
        let robot = Robot::new(maze.clone(), config.settings.physics, config.seed)?;
        let drive = WheelDrive::new(robot);
        Ok(Box::new(ScriptedWheels::new(drive, wheels.clone())))
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
        if let Some(fault) = episode.actions.fault(&self.plan) {
            return Err(fault);
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
    pub fn finish(mut self) -> Result<RecordSummary, Error> {
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
) -> Result<Knowledge, Error> {
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

fn require_empty(folder: &Path) -> Result<(), Error> {
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
