//! What a trial is: a world, and everything that can be chosen about it.

use serde::{Deserialize, Serialize};

use super::settings::Settings;
use crate::agent::{Agent, Estimator, Knowledge, Method, Misfit, Setup};
use xcs::bounds::{OutOfRange, within};
use xcscr_robot::arena::{
    Arena, ArenaKind, GridArena, Localisation, NoisyPerceptArena, PhysicsArena, PhysicsError,
    PhysicsParams, RewardingArena, SlippingArena, check_fit,
};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::Maze;

/// Everything that can be chosen about a trial, but the world. Stored with every run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The version of this program; another one may give other bytes.
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
    /// What was learned elsewhere, to start from.
    pub initial: Option<Knowledge>,
}

impl Config {
    /// An arena around a maze.
    ///
    /// # Errors
    /// When the world makes no sense in physics.
    pub fn build_arena(&self, maze: &Maze) -> Result<Box<dyn Arena>, PhysicsError> {
        let arena: Box<dyn Arena> = match self.arena {
            ArenaKind::Grid => Box::new(GridArena::new(maze.clone())),
            ArenaKind::Physics => {
                let mut params = self.settings.physics.clone();
                if self.sensor.is_sensed() {
                    params.localisation = Localisation::Estimated;
                }
                Box::new(PhysicsArena::new(maze.clone(), params, self.seed)?)
            }
        };
        let arena = match maze.rewarding_cells() {
            [] => arena,
            _ => Box::new(RewardingArena::new(arena)),
        };
        let Settings {
            arena: all, sensor, ..
        } = &self.settings;
        let arena = match all.slip > 0.0 {
            true => Box::new(SlippingArena::new(arena, all.slip, self.seed)),
            false => arena,
        };
        let width = self.sensor.width(maze);
        Ok(match sensor.flip_probability > 0.0 {
            true => Box::new(NoisyPerceptArena::new(
                arena,
                sensor.flip_probability,
                width,
                self.seed,
            )),
            false => arena,
        })
    }

    /// Does the robot only know what it senses, instead of its true pose?
    pub fn senses(&self) -> bool {
        let localisation = self.settings.physics.localisation;
        self.arena == ArenaKind::Physics
            && (self.sensor.is_sensed() || localisation == Localisation::Estimated)
    }

    /// The robot that drives; `None` on the grid.
    pub fn robot(&self) -> Option<&PhysicsParams> {
        (self.arena == ArenaKind::Physics).then_some(&self.settings.physics)
    }

    /// Accepts the plan when its robot fits into the maze; always on the grid.
    ///
    /// # Errors
    /// [`PhysicsError::TooNarrow`], with the place.
    pub fn check_fit(&self, maze: &Maze) -> Result<(), PhysicsError> {
        self.robot().map_or(Ok(()), |robot| check_fit(maze, robot))
    }

    /// The noise level: 0 on the grid.
    pub fn noise(&self) -> f64 {
        match self.arena {
            ArenaKind::Grid => 0.0,
            ArenaKind::Physics => self.settings.physics.noise,
        }
    }

    /// A learner that knows nothing yet, or what it is to start from. The settings must have been
    /// checked.
    ///
    /// # Errors
    /// When what it is to start from is of no use to it.
    pub fn build_method(&self, maze: &Maze) -> Result<Box<dyn Agent>, Misfit> {
        let Settings {
            xcs,
            reward,
            tabular,
            plus,
            map,
            ..
        } = self.settings.clone();
        let setup = Setup {
            xcs,
            reward,
            tabular,
            plus,
            map,
            sensed: self.sensor.is_sensed(),
            shows_surroundings: self.sensor.shows_only_surroundings(),
        };
        let actions = maze.action_count();
        let ring = self.sensor.ring(actions);
        let mut method = self.method.build(actions, ring, setup, self.seed);
        if let Some(knowledge) = &self.initial {
            knowledge.check(self.sensor.width(maze), actions)?;
            if !method.warm_start(knowledge) {
                return Err(Misfit::Useless(self.method.name()));
            }
        }
        Ok(method)
    }
}

/// A trial before it begins: the same plan gives the same bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The world.
    pub maze: Maze,
    /// All that can be chosen.
    pub config: Config,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            method: Method::XcscrPlus,
            arena: ArenaKind::Physics,
            sensor: Sensor::usual_in(ArenaKind::Physics),
            episodes: 180,
            seed: 1,
            settings: Settings::default(),
            initial: None,
        }
    }
}

impl Plan {
    /// A trial of 180 episodes of `xcscr-plus` in physics, on the percept `lidar`, from seed 1; each
    /// method below changes one of these choices, and no other.
    pub fn new(maze: Maze) -> Self {
        let config = Config::default();
        Self { maze, config }
    }

    /// With another reward method.
    #[must_use]
    pub fn method(mut self, method: Method) -> Self {
        self.config.method = method;
        self
    }

    /// In another arena. The percept stays: on the grid, `lidar` is what a perfect one would show.
    #[must_use]
    pub fn arena(mut self, arena: ArenaKind) -> Self {
        self.config.arena = arena;
        self
    }

    /// With another percept.
    #[must_use]
    pub fn sensor(mut self, sensor: Sensor) -> Self {
        self.config.sensor = sensor;
        self
    }

    /// With this many episodes; 1 to 1,000,000.
    #[must_use]
    pub fn episodes(mut self, episodes: u32) -> Self {
        self.config.episodes = episodes;
        self
    }

    /// From another root seed.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.config.seed = seed;
        self
    }

    /// With other settings.
    #[must_use]
    pub fn settings(mut self, settings: Settings) -> Self {
        self.config.settings = settings;
        self
    }

    /// Accepts the plan when every setting lies in its range.
    ///
    /// # Errors
    /// The first setting that does not.
    pub fn check(&self) -> Result<(), PlanError> {
        let Config {
            method,
            sensor,
            settings,
            ..
        } = &self.config;
        within("episodes", self.config.episodes, 1..=1_000_000)?;
        settings.check()?;
        let maps =
            method.may_draw_maps(&settings.plus) && settings.plus.estimator == Estimator::Map;
        if maps && !sensor.begins_with_neighbours() {
            return Err(PlanError::NoSurroundings {
                method: method.name(),
                sensor: sensor.name(),
            });
        }
        Ok(())
    }

    /// The plan with what the maze decides filled in; the same when it is filled in already.
    pub fn settled(mut self) -> Self {
        self.config.settings = self.config.settings.settled_in(&self.maze);
        self
    }

    /// The name of the folder that a run of this plan makes.
    pub fn folder_name(&self) -> String {
        let Config {
            method,
            arena,
            seed,
            ..
        } = &self.config;
        let (method, arena) = (method.name(), arena.name());
        format!("{}-{method}-{arena}-s{seed}", self.maze.name())
    }
}

/// Why a trial cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// A setting lies outside of its range.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// The knowledge is about another world.
    #[error(transparent)]
    Knowledge(#[from] Misfit),
    /// The method needs another percept.
    #[error(
        "`{method}` with `plus.estimator` = `map` needs a percept that begins with the eight cells around the robot, which \
         `{sensor}` does not; choose `neighbours` or `neighbours-position`, or in physics `lidar` or `lidar-position`"
    )]
    NoSurroundings {
        /// The method.
        method: &'static str,
        /// The percept that was chosen.
        sensor: &'static str,
    },
    /// The physics arena refuses the world.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
}
