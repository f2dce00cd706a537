//! The plan of a trial: a world, and all choices about the trial.

use serde::{Deserialize, Serialize};

use super::settings::Settings;
use crate::agent::{Agent, Frozen, Knowledge, Method, Misfit, Setup, WithHistory};
use xcs::bounds::{OutOfRange, within};
use xcscr_robot::arena::{
    Arena, ArenaKind, Disturbances, DisturbedArena, GridArena, Localisation, PhysicsArena,
    PhysicsError, PhysicsParams, check_fit,
};
use xcscr_robot::sensor::{History, Perception, Sensor};
use xcscr_robot::world::Maze;

/// All choices about a trial except the world. Stored with every run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The version of this program. Other versions may give different bytes.
    pub version: String,
    /// The reward method.
    pub method: Method,
    /// The arena.
    pub arena: ArenaKind,
    /// The percept.
    pub sensor: Sensor,
    /// The number of episodes; 1 to 1,000,000.
    pub episodes: u32,
    /// The root seed of all random streams.
    pub seed: u64,
    /// All settings.
    pub settings: Settings,
    /// Knowledge from another run to start from.
    pub initial: Option<Knowledge>,
}

impl Config {
    /// Builds an arena around a maze.
    ///
    /// # Errors
    /// When the world is invalid in physics.
    pub fn build_arena(&self, maze: &Maze) -> Result<Box<dyn Arena>, PhysicsError> {
        let arena: Box<dyn Arena> = match self.arena {
            ArenaKind::Grid => Box::new(GridArena::new(maze.clone())),
            ArenaKind::Physics => {
                let params = self.robot_params();
                Box::new(PhysicsArena::new(maze.clone(), params, self.seed)?)
            }
        };
        Ok(self.decorated(arena, maze))
    }

    /// Returns the robot parameters. A robot that perceives with its sensors also estimates its pose with them.
    fn robot_params(&self) -> PhysicsParams {
        let mut params = self.settings.physics.clone();
        if self.senses() {
            params.localisation = Localisation::Estimated;
        }
        params
    }

    /// Adds slips and observation errors to an arena around a maze, as configured.
    pub(super) fn decorated(&self, arena: Box<dyn Arena>, maze: &Maze) -> Box<dyn Arena> {
        let disturbances = Disturbances {
            slip: self.settings.arena.slip,
            flip_probability: self.settings.sensor.flip_probability,
            width: self.sensor.width(maze),
        };
        match disturbances.slip > 0.0 || disturbances.flip_probability > 0.0 {
            true => Box::new(DisturbedArena::new(arena, disturbances, self.seed)),
            false => arena,
        }
    }

    /// Returns the sensor, and the number of earlier steps in a percept.
    pub fn perception(&self) -> Perception {
        Perception {
            sensor: self.sensor,
            history: self.settings.sensor.history,
        }
    }

    /// Gives a learner in a maze the earlier steps in its percepts, as configured.
    pub fn with_history(&self, agent: Box<dyn Agent>, maze: &Maze) -> Box<dyn Agent> {
        WithHistory::around(agent, History::new(self.perception(), maze))
    }

    /// Returns an agent that follows knowledge in a maze without learning. In a world from a map it takes other ways
    /// around obstacles, unless moves slip or percepts have a history.
    pub fn policy(&self, knowledge: Knowledge, maze: &Maze) -> Box<dyn Agent> {
        let limit = self.settings.reward.step_threshold;
        let frozen = Frozen::new(knowledge, maze.action_count(), limit);
        let Settings { sensor, arena, .. } = &self.settings;
        match (sensor.history, arena.slip > 0.0) {
            // In the simulation nothing but its walls blocks a move in a maze.
            (0, false) if maze.is_from_map() => Box::new(frozen.with_detours(self.sensor, maze)),
            // A slipped move says nothing about the chosen one.
            _ => self.with_history(Box::new(frozen), maze),
        }
    }

    /// Returns true if the robot only knows its sensor readings, not its true pose.
    pub fn senses(&self) -> bool {
        let localisation = self.settings.physics.localisation;
        self.arena == ArenaKind::Physics
            && (self.sensor.is_sensed() || localisation == Localisation::Estimated)
    }

    /// Returns the robot parameters; `None` on the grid.
    pub fn robot(&self) -> Option<&PhysicsParams> {
        (self.arena == ArenaKind::Physics).then_some(&self.settings.physics)
    }

    /// Checks that the robot fits into the maze. Always succeeds on the grid.
    ///
    /// # Errors
    /// [`PhysicsError::TooNarrow`], with the place.
    pub fn check_fit(&self, maze: &Maze) -> Result<(), PhysicsError> {
        self.robot().map_or(Ok(()), |robot| check_fit(maze, robot))
    }

    /// Returns the noise level: 0 on the grid.
    pub fn noise(&self) -> f64 {
        match self.arena {
            ArenaKind::Grid => 0.0,
            ArenaKind::Physics => self.settings.physics.noise,
        }
    }

    /// Builds a learner, untrained or with the initial knowledge. The settings must have been
    /// checked.
    ///
    /// # Errors
    /// When the method cannot use the initial knowledge.
    pub fn build_method(&self, maze: &Maze) -> Result<Box<dyn Agent>, Misfit> {
        let mut settings = self.settings.clone();
        // A success from a near start says nothing about the steps that a far start needs.
        settings.reward.learning_step_threshold &= maze.start().is_some();
        let setup = Setup {
            xcs: settings.xcs,
            reward: settings.reward,
            tabular: settings.tabular,
            plus: settings.plus,
            layout: self.sensor.layout(maze),
        };
        let actions = maze.action_count();
        let ring = self.sensor.ring(actions);
        let mut method = self.method.build(actions, ring, setup, self.seed);
        if let Some(knowledge) = &self.initial {
            knowledge.check(self.perception(), maze)?;
            if !method.warm_start(knowledge) {
                return Err(Misfit::Useless(self.method.name()));
            }
        }
        Ok(method)
    }
}

/// A trial before it begins. The same plan gives the same bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The world.
    pub maze: Maze,
    /// All other choices.
    pub config: Config,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            method: Method::default(),
            arena: ArenaKind::Physics,
            sensor: Sensor::usual_in(ArenaKind::Physics),
            episodes: 180,
            seed: 1,
            settings: Settings::of(Method::default()),
            initial: None,
        }
    }
}

impl Plan {
    /// Creates a plan for 180 episodes of `xcscr-plus` in physics, with the percept `lidar-position` and
    /// seed 1.
    pub fn new(maze: Maze) -> Self {
        let config = Config::default();
        Self { maze, config }
    }

    /// Sets the reward method. Settings that were not changed become the default settings of the method.
    #[must_use]
    pub fn method(mut self, method: Method) -> Self {
        if self.config.settings == Settings::of(self.config.method) {
            self.config.settings = Settings::of(method);
        }
        self.config.method = method;
        self
    }

    /// Sets the arena. The percept does not change: on the grid, `lidar` shows the readings of a
    /// perfect lidar.
    #[must_use]
    pub fn arena(mut self, arena: ArenaKind) -> Self {
        self.config.arena = arena;
        self
    }

    /// Sets the percept.
    #[must_use]
    pub fn sensor(mut self, sensor: Sensor) -> Self {
        self.config.sensor = sensor;
        self
    }

    /// Sets the number of episodes; 1 to 1,000,000.
    #[must_use]
    pub fn episodes(mut self, episodes: u32) -> Self {
        self.config.episodes = episodes;
        self
    }

    /// Sets the root seed.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.config.seed = seed;
        self
    }

    /// Sets all settings.
    #[must_use]
    pub fn settings(mut self, settings: Settings) -> Self {
        self.config.settings = settings;
        self
    }

    /// Checks that every setting is in its range.
    ///
    /// # Errors
    /// The first setting that is out of range, or an unsuitable percept.
    pub fn check(&self) -> Result<(), PlanError> {
        let config = &self.config;
        within("episodes", config.episodes, 1..=1_000_000)?;
        config.settings.check()?;
        Ok(())
    }

    /// Returns the plan with the values that depend on the maze filled in, [fitted](Self::fitted) to
    /// its robot. Has no effect on a settled plan.
    pub fn settled(self) -> Self {
        let mut plan = self.fitted();
        plan.config.settings = plan.config.settings.settled_in(&plan.maze);
        plan.config.settings.physics = plan.config.robot_params();
        plan
    }

    /// Returns the plan with the cells and moves of a map that its robot can use. A map without a way
    /// for the robot stays as it is, and building the arena reports the fault.
    #[must_use]
    pub fn fitted(mut self) -> Self {
        let needed_m = self.config.robot().map(|robot| robot.needed_m());
        if let Some(maze) = needed_m.and_then(|needed_m| self.maze.for_robot(needed_m)) {
            self.maze = maze;
        }
        self
    }

    /// Returns the folder name of a run of this plan.
    pub fn folder_name(&self) -> String {
        let Config { seed, .. } = self.config;
        let (method, arena) = (self.config.method.name(), self.config.arena.name());
        format!("{}-{method}-{arena}-s{seed}", self.maze.name())
    }
}

/// Errors when running a trial.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// A setting is out of its range.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// The knowledge does not fit the world.
    #[error(transparent)]
    Knowledge(#[from] Misfit),
    /// The world is invalid in physics.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
}
