//! The origin of a policy, written into each exported file.

use serde::Serialize;

use crate::agent::Knowledge;
use crate::sensor::{ANYTHING, Sensor};
use crate::trial::Plan;
use crate::world::Maze;
use xcs::{Action, Condition};

/// The run that a policy comes from, and the words for its bits and actions.
#[derive(Debug, Clone)]
pub struct Provenance {
    /// The world.
    pub(super) maze: Maze,
    /// The percept.
    pub(super) sensor: Sensor,
    /// The robot's dimensions; `None` on the grid.
    pub(super) robot: Option<Robot>,
    /// The facts about the run.
    pub(super) facts: Facts,
}

/// The robot's dimensions, in metres, m/s and rad/s.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Robot {
    pub radius_m: f64,
    pub wheel_base_m: f64,
    pub max_speed_mps: f64,
    pub max_turn_radps: f64,
}

/// The run that a policy comes from.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Facts {
    /// The program that wrote the file, and its version.
    program: String,
    /// The world's name.
    pub(super) world: String,
    /// The percept's name.
    sensor: String,
    /// The method's name; absent for a lone file of rules.
    #[serde(skip_serializing_if = "Option::is_none")]
    method: Option<String>,
    /// The root seed; absent for a lone file of rules.
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
    /// CRC-32 of the rules as JSON.
    rules_crc32: String,
}

impl Provenance {
    /// Collects the origin of `knowledge`. For a lone file of rules, only the world and the percept
    /// are known.
    pub fn new(plan: &Plan, knowledge: &Knowledge, of_a_run: bool) -> Self {
        let Plan { maze, config } = plan;
        let json = serde_json::to_vec(knowledge).unwrap_or_default();
        let facts = Facts {
            program: concat!("xcscr ", env!("CARGO_PKG_VERSION")).to_owned(),
            world: maze.name().to_owned(),
            sensor: config.sensor.name().to_owned(),
            method: of_a_run.then(|| config.method.name().to_owned()),
            seed: of_a_run.then_some(config.seed),
            rules_crc32: format!("{:08x}", crc32fast::hash(&json)),
        };
        Self {
            maze: maze.clone(),
            sensor: config.sensor,
            robot: config.robot().map(|robot| Robot {
                radius_m: robot.radius_m,
                wheel_base_m: robot.wheel_base_m,
                max_speed_mps: robot.max_speed_mps,
                max_turn_radps: robot.max_turn_radps,
            }),
            facts,
        }
    }

    /// Returns the facts as lines for a comment. The names of worlds cannot contain the end of a
    /// comment.
    pub(super) fn lines(&self) -> Vec<String> {
        let facts = &self.facts;
        let run = facts.method.as_ref().zip(facts.seed);
        let lines = [
            Some(format!("Written by {}.", facts.program)),
            Some(format!("World {}, percept {}.", facts.world, facts.sensor)),
            run.map(|(method, seed)| format!("Learned by {method} with seed {seed}.")),
            Some(format!("CRC-32 of the rules: {}.", facts.rules_crc32)),
        ];
        lines.into_iter().flatten().collect()
    }

    /// Returns the meaning of a bit of a percept when it is 1.
    pub(super) fn bit(&self, bit: usize) -> String {
        let words = self
            .sensor
            .words(&self.maze, &|at| (at == bit).then_some(true));
        match words.as_str() {
            ANYTHING => "always 0".to_owned(),
            _ => words,
        }
    }

    /// Describes the demands of a condition in words.
    pub(super) fn words(&self, condition: &Condition) -> String {
        self.sensor.words(&self.maze, condition)
    }

    /// Returns the name of an action.
    pub(super) fn action(&self, action: Action) -> String {
        self.maze.action_name(action)
    }
}
