//! All settings of a trial.

use serde::{Deserialize, Serialize};

use super::toml_text::MOST_TOML_BYTES;
use crate::agent::{self, Method, Sharing};
use crate::episode;
use xcs::bounds::{OutOfRange, Setting};
use xcscr_robot::arena::{ArenaParams, PhysicsParams};
use xcscr_robot::sensor::SensorParams;
use xcscr_robot::world::{Maze, Paths};

/// The step-threshold from the maze, in multiples of the longest shortest path. It leaves room to
/// explore.
pub(super) const PATHS_AN_EPISODE: u32 = 4;
/// The largest step-threshold that settings can hold.
pub(super) const MOST_STEPS: u32 = 1_000_000;

/// All settings of a trial, by section.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// The classifier system.
    pub xcs: xcs::Params,
    /// Rewards and reward methods.
    pub reward: agent::Params,
    /// `xcscr-plus` and `r-max`.
    pub plus: agent::PlusParams,
    /// Tabular methods.
    pub tabular: agent::TabularParams,
    /// Exploration.
    pub episode: episode::Params,
    /// Settings of all arenas.
    pub arena: ArenaParams,
    /// Percepts.
    pub sensor: SensorParams,
    /// The robot and its noise.
    pub physics: PhysicsParams,
}

impl Settings {
    /// Returns the default settings of a method. They differ from [`Settings::default`] for the methods of the XCS
    /// family: `docs/src/how-to/choose-a-method.md` says how they were chosen.
    pub fn of(method: Method) -> Self {
        let mut settings = Self::default();
        let Self {
            xcs,
            reward,
            episode,
            ..
        } = &mut settings;
        match method {
            Method::Xcs => {
                (xcs.population_size, xcs.dont_care, xcs.mu) = (3200, 0.0, 0.01);
                (xcs.theta_ga, xcs.epsilon_0) = (100, 1.0);
                (reward.step_threshold, reward.gamma) = (600, 0.71);
                episode.explore = 0.7;
            }
            Method::Xcsam => {
                (xcs.population_size, xcs.dont_care, xcs.mu) = (3200, 0.0, 0.02);
                (xcs.theta_ga, xcs.initial_prediction) = (100, 100.0);
                (reward.step_threshold, reward.gamma) = (600, 0.71);
                episode.explore = 0.5;
            }
            Method::AdaptedEven => {
                (xcs.population_size, xcs.dont_care, xcs.mu) = (6400, 0.05, 0.01);
                (xcs.theta_ga, xcs.epsilon_0) = (100, 5.0);
                xcs.action_set_subsumption = false;
                episode.explore = 0.2;
            }
            Method::AdaptedDiscounted => {
                (xcs.population_size, xcs.dont_care, xcs.mu) = (6400, 0.0, 0.02);
                (xcs.theta_ga, xcs.epsilon_0) = (100, 1.0);
                xcs.action_set_subsumption = false;
                (reward.step_threshold, reward.gamma) = (600, 0.8);
            }
            Method::Xcscr | Method::XcscrCoevolved => {
                (xcs.population_size, xcs.dont_care, xcs.mu) = (3200, 0.02, 0.05);
                xcs.epsilon_0 = 1.0;
                reward.step_threshold = 600;
                reward.beta_collision = 0.05;
                episode.explore = 0.5;
            }
            Method::XcscrPlus => {
                xcs.dont_care = 0.2;
                reward.step_threshold = 600;
                reward.sharing = Sharing::Even;
                reward.beta_collision = 0.05;
            }
            Method::QLearning | Method::SarsaLambda | Method::DynaQ | Method::RMax => {}
        }
        settings
    }

    /// The maximum size of a settings file, in bytes.
    pub const MOST_BYTES: u64 = MOST_TOML_BYTES;

    /// Returns the settings with the step-threshold from the maze filled in, unless it was set.
    pub fn settled_in(mut self, maze: &Maze) -> Self {
        if self.reward.step_threshold_from_maze {
            let longest = Paths::new(maze).longest(maze);
            let wanted = longest.saturating_mul(PATHS_AN_EPISODE).min(MOST_STEPS);
            let least = self.reward.step_threshold;
            self.reward.step_threshold = least.max(wanted);
        }
        self
    }

    /// Returns the declarations of all settings, sorted by key.
    pub fn declared() -> Vec<Setting> {
        let mut all = [
            xcs::Params::declared(),
            agent::Params::declared(),
            agent::PlusParams::declared(),
            agent::TabularParams::declared(),
            episode::Params::declared(),
            ArenaParams::declared(),
            SensorParams::declared(),
            PhysicsParams::declared_with_parts(),
        ]
        .concat();
        all.sort_by_key(|setting| setting.key);
        all
    }

    /// Checks that each setting is in its range.
    ///
    /// # Errors
    /// [`OutOfRange`] for the first setting that is not.
    pub fn check(&self) -> Result<(), OutOfRange> {
        self.xcs.check()?;
        self.reward.check()?;
        self.reward.check_filter()?;
        self.plus.check()?;
        self.tabular.check()?;
        self.episode.check()?;
        self.arena.check()?;
        self.sensor.check()?;
        self.physics.check()
    }
}
