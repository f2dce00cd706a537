//! What a recording says about the run it comes from.

use std::collections::BTreeMap;

use super::write::RecordMode;
use crate::sensor::Sensor;

/// The facts of a run that its recordings carry.
#[derive(Debug, Clone)]
pub struct RunInfo {
    /// The world file's text; attached as `world.json`.
    pub world_json: String,
    /// All settings, resolved; attached as `config.json`.
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
}

impl RunInfo {
    /// The probability that actions slip, as the settings have it; 0 where they say nothing.
    pub(super) fn slip(&self) -> f64 {
        let config = serde_json::from_str(&self.config_json).ok();
        let slip = |config: serde_json::Value| config.pointer("/settings/arena/slip")?.as_f64();
        config.and_then(slip).unwrap_or(0.0)
    }

    /// The entries of the metadata record `run`.
    pub(super) fn metadata(
        &self,
        world: &str,
        mode: RecordMode,
        episode: Option<u32>,
    ) -> BTreeMap<String, String> {
        let file = episode.map_or_else(|| "run".to_owned(), |number| number.to_string());
        let entries = [
            ("arena", self.arena.clone()),
            ("episode", file),
            ("episodes", self.episodes.to_string()),
            ("method", self.method.clone()),
            ("record", mode.to_string()),
            ("seed", self.seed.to_string()),
            ("sensor", self.sensor.name().to_owned()),
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("world", world.to_owned()),
        ];
        entries.map(|(key, text)| (key.to_owned(), text)).into()
    }
}

/// What the robot looks like: a disc on two wheels. All lengths are above 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotShape {
    /// Radius of the disc, in metres.
    pub radius_m: f64,
    /// Distance of the wheels from each other, in metres.
    pub wheel_base_m: f64,
    /// Radius of a wheel, in metres.
    pub wheel_radius_m: f64,
}

impl RobotShape {
    /// A robot that fits into cells of this size, in metres.
    pub fn for_cell(cell_size_m: f64) -> Self {
        Self {
            radius_m: 0.3 * cell_size_m,
            wheel_base_m: 0.4 * cell_size_m,
            wheel_radius_m: 0.09 * cell_size_m,
        }
    }
}
