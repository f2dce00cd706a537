//! Facts about the run that a recording carries.

use std::collections::BTreeMap;
use std::fmt;

use super::mode::RecordMode;
use xcscr_robot::arena::ArenaKind;
use xcscr_robot::sensor::Sensor;

/// The key of the metadata record `run` that marks a run that is not a training.
pub(super) const KIND: &str = "kind";

/// The key of the metadata record `run` with the radius of the robot, in metres.
pub const RADIUS: &str = "robot_radius_m";

/// The kind of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunKind {
    /// A method learns.
    Training,
    /// A learned policy drives, and nothing is learned.
    Evaluation,
    /// An agent outside of this program chooses the actions. The number of episodes is unknown.
    External,
}

impl RunKind {
    /// Returns the value of [`KIND`]. A training has no such entry.
    fn entry(self) -> Option<&'static str> {
        match self {
            Self::Training => None,
            Self::Evaluation => Some("evaluation"),
            Self::External => Some("external"),
        }
    }

    /// Returns the kind with this value of [`KIND`]; `None` for an unknown value.
    pub(super) fn of_entry(text: Option<&str>) -> Option<Self> {
        let all = [Self::Training, Self::Evaluation, Self::External];
        all.into_iter().find(|kind| kind.entry() == text)
    }
}

/// The facts of a run that its recordings carry.
#[derive(Debug, Clone)]
pub struct RunInfo {
    /// The world file's text; attached as `world.json`.
    pub world_json: String,
    /// The selected options, and the settings that differ from this version's defaults; attached as
    /// `config.json`.
    pub config_json: String,
    /// The root seed.
    pub seed: u64,
    /// The reward method's name, as on the command line.
    pub method: String,
    /// The arena's name, as on the command line.
    pub arena: String,
    /// The robot's sensor.
    pub sensor: Sensor,
    /// The number of planned episodes.
    pub episodes: u32,
    /// The robot's dimensions.
    pub robot: RobotShape,
    /// The probability that an action slips.
    pub slip: f64,
    /// The reward for reaching a goal.
    pub goal: f64,
    /// The kind of the run.
    pub kind: RunKind,
}

impl RunInfo {
    /// Returns world, method, arena, sensor and seed in one line.
    pub(super) fn heading(&self, world: &str) -> String {
        let (method, arena, seed) = (&self.method, &self.arena, self.seed.to_string());
        heading([world, method, arena, self.sensor.name(), &seed])
    }

    /// Returns the distance between the wheels in metres; `None` in arenas without wheels.
    pub(super) fn wheel_base_m(&self) -> Option<f64> {
        (self.arena == ArenaKind::Physics.name()).then_some(self.robot.wheel_base_m)
    }

    /// Returns the entries of the metadata record `run`.
    pub(super) fn metadata(
        &self,
        world: &str,
        mode: RecordMode,
        extent: RecordingKind,
    ) -> BTreeMap<String, String> {
        let entries = [
            ("arena", self.arena.clone()),
            ("episode", extent.to_string()),
            ("episodes", self.episodes.to_string()),
            ("method", self.method.clone()),
            ("record", mode.to_string()),
            (RADIUS, self.robot.radius_m.to_string()),
            ("seed", self.seed.to_string()),
            ("sensor", self.sensor.name().to_owned()),
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("world", world.to_owned()),
        ];
        let kind = self.kind.entry().map(|kind| (KIND, kind.to_owned()));
        let is_known = |key: &str| self.kind != RunKind::External || key != "episodes";
        let entries = entries.into_iter().filter(|(key, _)| is_known(key));
        let entries = entries.chain(kind);
        entries.map(|(key, text)| (key.to_owned(), text)).collect()
    }
}

/// Returns world, method, arena, sensor and seed in one line.
pub fn heading([world, method, arena, sensor, seed]: [&str; 5]) -> String {
    format!("{world}: {method} on {arena}, {sensor}, seed {seed}")
}

/// The kind of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecordingKind {
    /// The whole run, without events that happen more often than once per step.
    Run,
    /// One episode, by its number from 1.
    Episode(u32),
}

impl RecordingKind {
    /// Returns the file name in the folder of the run.
    pub fn file_name(self) -> String {
        match self {
            Self::Run => "run.mcap".to_owned(),
            Self::Episode(number) => format!("ep-{number:04}.mcap"),
        }
    }

    /// Returns the episode number if the recording shows a single episode.
    pub fn episode(self) -> Option<u32> {
        match self {
            Self::Episode(number) => Some(number),
            Self::Run => None,
        }
    }

    /// Parses the entry `episode` of the metadata record `run`. Unknown texts give
    /// [`Run`](Self::Run).
    pub fn of_entry(text: &str) -> Self {
        text.parse().map_or(Self::Run, Self::Episode)
    }
}

impl fmt::Display for RecordingKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Run => f.write_str("run"),
            Self::Episode(number) => write!(f, "{number}"),
        }
    }
}

/// The robot's dimensions: a disc on two wheels. All lengths are above 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotShape {
    /// Radius of the disc, in metres.
    pub radius_m: f64,
    /// Distance between the wheels, in metres.
    pub wheel_base_m: f64,
}

impl RobotShape {
    /// Returns the shape drawn for a robot in the grid world, with cells of this size in metres.
    pub fn for_cell(cell_size_m: f64) -> Self {
        Self {
            radius_m: 0.3 * cell_size_m,
            wheel_base_m: 0.4 * cell_size_m,
        }
    }

    /// Returns the radius of a wheel as drawn, in metres.
    pub(super) fn wheel_radius_m(&self) -> f64 {
        0.3 * self.radius_m
    }
}
