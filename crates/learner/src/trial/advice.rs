//! Changes to a failing plan, as data: printed as advice, and applied by a test.

use std::fmt;

use super::plan::Plan;
use super::resolve::{Resolved, STEP_THRESHOLD};
use super::settings::{MOST_STEPS, PATHS_AN_EPISODE};
use super::settings_error::SettingsError;
use super::warning::misleading;
use crate::agent::{Estimator, Method, MotionPrior};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Maze, Paths};

/// The minimum number of episodes that is advised.
const LEAST_EPISODES: u32 = 30;

/// One change to a plan.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Use another method.
    Method(Method),
    /// Use another percept.
    Sensor(Sensor),
    /// Set a setting, by its full name, to another value.
    Setting(&'static str, String),
    /// Run more episodes.
    Episodes(u32),
}

/// Changes to a plan that help together. `tests/learner/advice.rs` applies the advice in failing situations and
/// checks that it helps.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice(Vec<Change>);

impl Advice {
    /// Creates advice from changes; `None` if there are none.
    pub(super) fn of(changes: Vec<Change>) -> Option<Self> {
        (!changes.is_empty()).then_some(Self(changes))
    }

    /// Returns the changes.
    pub fn changes(&self) -> &[Change] {
        &self.0
    }

    /// Returns the plan with the changes.
    ///
    /// # Errors
    /// When a setting is out of its range in combination with another setting of the plan.
    pub fn applied_to(&self, plan: &Plan) -> Result<Plan, SettingsError> {
        let mut plan = plan.clone();
        for change in &self.0 {
            let config = &mut plan.config;
            match change {
                Change::Method(method) => config.method = *method,
                Change::Sensor(sensor) => config.sensor = *sensor,
                Change::Episodes(episodes) => config.episodes = *episodes,
                Change::Setting(key, value) => {
                    let set = [format!("{key}={value}")];
                    config.settings = Resolved::new(&config.settings, &[], &set)?.settings;
                }
            }
        }
        Ok(plan)
    }
}

/// Formats the advice as arguments of `xcscr train`.
impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let arguments = self.0.iter().map(|change| match change {
            Change::Method(method) => format!("--method {}", method.name()),
            Change::Sensor(sensor) => format!("--sensor {}", sensor.name()),
            Change::Setting(key, value) => format!("--set {key}={value}"),
            Change::Episodes(episodes) => format!("--episodes {episodes}"),
        });
        f.write_str(&arguments.collect::<Vec<_>>().join(" "))
    }
}

impl Plan {
    /// Returns changes for a plan whose final policy was not optimal: everything that prevents the default method
    /// from solving it, or twice the episodes if nothing does.
    pub fn advice(&self) -> Option<Advice> {
        let plan = self.clone().settled();
        let mut changes: Vec<Change> = [
            plan.advised_method(),
            plan.advised_sensor(),
            plan.advised_threshold(),
            plan.advised_estimator(),
        ]
        .into_iter()
        .flatten()
        .collect();
        changes.extend(plan.advised_switches());
        let enough = match changes.is_empty() {
            true => plan.config.episodes.saturating_mul(2).max(LEAST_EPISODES),
            false => plan.config.episodes.max(LEAST_EPISODES),
        };
        if enough > plan.config.episodes {
            changes.push(Change::Episodes(enough));
        }
        Advice::of(changes)
    }

    /// The default method, if the plan uses another one.
    pub(super) fn advised_method(&self) -> Option<Change> {
        let is_model_based = matches!(self.config.method, Method::XcscrPlus | Method::RMax);
        (!is_model_based).then_some(Change::Method(Method::XcscrPlus))
    }

    /// A percept with the position: in large mazes, and if the percept is aliased and no map can be built from it. A
    /// percept for a map in mazes with auxiliary rewards: no percept shows which of them were collected.
    pub(super) fn advised_sensor(&self) -> Option<Change> {
        let Self { maze, config } = self;
        let sensor = config.sensor;
        if !maze.rewarding_cells().is_empty() {
            let mapped = match sensor.is_sensed() {
                true => Sensor::Lidar,
                false => Sensor::Neighbours,
            };
            return (!sensor.shows_only_surroundings()).then_some(Change::Sensor(mapped));
        }
        let with_position = match sensor.is_sensed() {
            true => Sensor::LidarPosition,
            false => Sensor::NeighboursPosition,
        };
        let has_position = [with_position, Sensor::Position].contains(&sensor);
        let maps = sensor.shows_only_surroundings() && !is_large(maze);
        let misleads = || {
            let paths = Paths::with_slip(maze, config.settings.arena.slip);
            !misleading(sensor, maze, &paths).is_empty()
        };
        let helps = !has_position && !maps && (is_large(maze) || misleads());
        helps.then_some(Change::Sensor(with_position))
    }

    /// A step threshold of several shortest paths, if episodes end before the longest of them.
    pub(super) fn advised_threshold(&self) -> Option<Change> {
        let Self { maze, config } = self;
        let longest = Paths::with_slip(maze, config.settings.arena.slip).longest(maze);
        let steps = longest.saturating_mul(PATHS_AN_EPISODE);
        let is_short = config.settings.reward.step_threshold < longest;
        (is_short && steps <= MOST_STEPS)
            .then(|| Change::Setting(STEP_THRESHOLD, steps.to_string()))
    }

    /// The estimator that switches to a map automatically.
    pub(super) fn advised_estimator(&self) -> Option<Change> {
        let fixed = self.config.settings.plus.estimator != Estimator::Auto;
        fixed.then(|| Change::Setting("plus.estimator", "auto".to_owned()))
    }

    /// The other switches of the default method that are off.
    fn advised_switches(&self) -> Vec<Change> {
        let settings = &self.config.settings;
        let known = settings.map.motion_model != MotionPrior::Known;
        let planned = !settings.plus.planned_exploration;
        let switches = [
            (known, "map.motion_model", "known"),
            (planned, "plus.planned_exploration", "true"),
        ];
        let off = switches.into_iter().filter(|(off, ..)| *off);
        off.map(|(_, key, value)| Change::Setting(key, value.to_owned()))
            .collect()
    }
}

/// Returns true if a maze is so large that the percept has the position by default.
fn is_large(maze: &Maze) -> bool {
    let usual = Sensor::usual_for(xcscr_robot::arena::ArenaKind::Grid, maze);
    usual == Sensor::NeighboursPosition
}
