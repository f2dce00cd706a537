//! What a recording says about the run it comes from.

use std::collections::BTreeMap;
use std::fmt;

use super::mode::RecordMode;
use crate::sensor::Sensor;

/// The entry of the metadata record `run` that tells an evaluation from a training ...
pub(super) const KIND: &str = "kind";
/// ... and what it says; a training lacks it.
pub(super) const EVALUATION: &str = "evaluation";

/// The facts of a run that its recordings carry.
#[derive(Debug, Clone)]
pub struct RunInfo {
    /// The world file's text; attached as `world.json`.
    pub world_json: String,
    /// What was chosen, and the settings that differ from the defaults of this version; attached as
    /// `config.json`.
    pub config_json: String,
    /// The root seed.
    pub seed: u64,
    /// The reward method's name, as on the command line.
    pub method: String,
    /// The arena's name, as on the command line.
    pub arena: String,
    /// How the robot perceives.
    pub sensor: Sensor,
    /// How many episodes are planned.
    pub episodes: u32,
    /// What the robot looks like.
    pub robot: RobotShape,
    /// The probability that an action slips.
    pub slip: f64,
    /// What a goal pays.
    pub goal: f64,
    /// Is nothing learned in it?
    pub is_evaluation: bool,
}

impl RunInfo {
    /// World, method and seed in a line.
    pub(super) fn heading(&self, world: &str) -> String {
        let (method, arena, sensor) = (&self.method, &self.arena, self.sensor.name());
        format!("{world}: {method} on {arena}, {sensor}, seed {}", self.seed)
    }

    /// The entries of the metadata record `run`.
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
            ("seed", self.seed.to_string()),
            ("sensor", self.sensor.name().to_owned()),
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("world", world.to_owned()),
        ];
        let kind = self.is_evaluation.then(|| (KIND, EVALUATION.to_owned()));
        let entries = entries.into_iter().chain(kind);
        entries.map(|(key, text)| (key.to_owned(), text)).collect()
    }
}

/// How much of a run a recording shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecordingKind {
    /// All of it, but what happens more often than once per step.
    Run,
    /// Its turning points, and a drive of what was learned.
    Highlights,
    /// One episode, by its number from 1.
    Episode(u32),
    /// The highlights of two runs side by side.
    Comparison,
}

impl RecordingKind {
    /// The name of the file in the folder of a run.
    pub fn file_name(self) -> String {
        match self {
            Self::Run => "run.mcap".to_owned(),
            Self::Highlights => "highlights.mcap".to_owned(),
            Self::Episode(number) => format!("ep-{number:04}.mcap"),
            Self::Comparison => "comparison.mcap".to_owned(),
        }
    }

    /// The episode, if it is one.
    pub fn episode(self) -> Option<u32> {
        match self {
            Self::Episode(number) => Some(number),
            Self::Run | Self::Highlights | Self::Comparison => None,
        }
    }

    /// What the entry `episode` of the metadata record `run` says; the run for anything unknown.
    pub fn of_entry(text: &str) -> Self {
        match text {
            "highlights" => Self::Highlights,
            "comparison" => Self::Comparison,
            text => text.parse().map_or(Self::Run, Self::Episode),
        }
    }
}

impl fmt::Display for RecordingKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Run => f.write_str("run"),
            Self::Highlights => f.write_str("highlights"),
            Self::Comparison => f.write_str("comparison"),
            Self::Episode(number) => write!(f, "{number}"),
        }
    }
}

/// What the robot looks like: a disc on two wheels. All lengths are above 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotShape {
    /// Radius of the disc, in metres.
    pub radius_m: f64,
    /// Distance of the wheels from each other, in metres.
    pub wheel_base_m: f64,
}

impl RobotShape {
    /// A robot that fits into cells of this size, in metres: a symbol, for the grid.
    pub fn for_cell(cell_size_m: f64) -> Self {
        Self {
            radius_m: 0.3 * cell_size_m,
            wheel_base_m: 0.4 * cell_size_m,
        }
    }

    /// Radius of a wheel as it is drawn, in metres.
    pub(super) fn wheel_radius_m(&self) -> f64 {
        0.3 * self.radius_m
    }
}
