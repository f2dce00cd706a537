//! One trial: a fresh learner, run for a number of episodes from one seed.

mod bounds;
mod compacted;
mod evaluation;
mod greedy;
mod judge;
mod plan;
mod resolve;
mod robot;
mod settings;
mod settings_error;
mod toml_text;
mod unread;
mod warning;
mod why;

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

pub use bounds::Bounds;
pub use compacted::Compacted;
pub use evaluation::Evaluation;
pub use greedy::GreedySteps;
pub use judge::{Judge, steps_to_goal};
pub use plan::{Config, Plan, PlanError};
pub use resolve::Resolved;
pub use resolve::{FROM_MAZE, STEP_THRESHOLD, flatten, similar, value_of};
pub use robot::{RobotError, RobotProfile, ScanOrder};
pub use settings::Settings;
pub use settings_error::{SettingOrigin, SettingsError};
pub use toml_text::{MOST_TOML_BYTES, shortened};
pub use unread::{Unread, why_unread};
pub use warning::Warning;
pub use why::{WeightedRule, Why};

use crate::agent::{Agent, Chosen, Explorer, RuleUpdates};
use crate::episode::{
    self, BestChoices, Episode, MistakeCounter, Mistakes, Observer, PolicyMap, Start,
};
use xcs::random::Stream;
use xcscr_robot::arena::Arena;
use xcscr_robot::streams::StreamName;
use xcscr_robot::world::{Cell, Paths, Starts};

/// The figures of a trial so far.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Progress {
    /// Finished episodes.
    pub episodes: u32,
    /// Steps taken in the environment.
    pub steps: u64,
    /// Steps that ended in a collision.
    pub collisions: u64,
    /// The first episode after which the greedy policy was globally optimal.
    pub first_optimal_episode: Option<u32>,
    /// Steps taken up to the end of that episode.
    pub first_optimal_env_steps: Option<u64>,
    /// The first episode that was itself optimal: as short as the shortest path or, if actions slip, with only best
    /// actions.
    pub first_executed_optimal_episode: Option<u32>,
    /// Episodes after which the greedy policy was globally optimal.
    pub optimal_episodes: u32,
    /// True if the greedy policy is globally optimal now.
    pub optimal: bool,
    /// The fewest steps of an episode that reached a goal.
    pub best_steps: Option<u32>,
    /// The number of steps by decision source.
    #[serde(default)]
    pub chosen: Chosen,
    /// The number of steps by decision source until the greedy policy was first globally optimal.
    #[serde(default)]
    pub chosen_before: Chosen,
    /// Perception errors; 0 for a robot that does not depend on sensors.
    #[serde(default)]
    pub mistakes: Mistakes,
    /// The maximum number of rules after an episode.
    #[serde(default)]
    pub most_rules: usize,
    /// Episodes that reached a goal.
    #[serde(default)]
    pub reached_goal: u32,
    /// Steps after which the short-term filter lowered a value (Alg. 1).
    #[serde(default)]
    pub filter_firings: u64,
    /// Episodes after which a policy was imprinted (Alg. 2).
    #[serde(default)]
    pub imprintings: u32,
    /// The number of updates of rules, by their source.
    #[serde(default)]
    pub rule_updates: RuleUpdates,
}

impl Progress {
    /// Returns the share of optimal episodes after the first optimal one; `None` if there are no
    /// episodes after it.
    pub fn optimal_share_after_first(&self) -> Option<f64> {
        let after = self.episodes.checked_sub(self.first_optimal_episode?)?;
        let optimal = self.optimal_episodes.saturating_sub(1);
        (after > 0).then(|| f64::from(optimal) / f64::from(after))
    }
}

impl Plan {
    /// Runs the trial to its end, without recording.
    ///
    /// # Errors
    /// When the world or a setting is invalid.
    pub fn run(self) -> Result<Trial, PlanError> {
        let mut trial = Trial::new(self)?;
        // The observer never ends the trial early.
        let _ = trial.run(&mut ());
        Ok(trial)
    }
}

/// A trial in progress. Run it episode by episode, or all at once.
pub struct Trial {
    plan: Plan,
    judge: Judge,
    arena: Box<dyn Arena>,
    method: Box<dyn Agent>,
    explorer: Explorer,
    /// The cells in which an episode can start.
    start_cells: Starts,
    starts: Stream,
    progress: Progress,
}

impl Trial {
    /// Creates a trial at its beginning. Its [plan](Self::plan) is [settled](Plan::settled).
    ///
    /// # Errors
    /// When the world or a setting is invalid.
    pub fn new(plan: Plan) -> Result<Self, PlanError> {
        plan.check()?;
        let plan = plan.settled();
        let agent = plan.config.build_method(&plan.maze)?;
        Self::with_agent(plan, agent)
    }

    /// Like [`new`](Self::new), with a custom agent in place of the plan's method. Its percepts have the configured
    /// history.
    ///
    /// # Errors
    /// When the world or a setting is invalid.
    pub fn with_agent(plan: Plan, agent: Box<dyn Agent>) -> Result<Self, PlanError> {
        plan.check()?;
        let plan = plan.settled();
        let Plan { maze, config } = &plan;
        let exploration = Stream::new(config.seed, StreamName::Exploration);
        Ok(Self {
            judge: Judge::new(maze, config.sensor, config.settings.arena.slip),
            arena: config.build_arena(maze)?,
            method: config.with_history(agent, maze),
            explorer: Explorer::new(config.settings.episode.explore, exploration),
            start_cells: Starts::new(maze),
            starts: Stream::new(config.seed, StreamName::Start),
            progress: Progress::default(),
            plan,
        })
    }

    /// Returns true if all episodes are done.
    pub fn is_finished(&self) -> bool {
        self.progress.episodes >= self.plan.config.episodes
    }

    /// Runs the next episode. `Break` means that the observer wants the trial to end.
    pub fn run_episode(&mut self, observer: &mut dyn Observer) -> (Episode, ControlFlow<()>) {
        let start = self.next_start();
        let mut choices = BestChoices::by(self.judge.paths());
        let mut watch = MistakeCounter::new(self.plan.config.sensor);
        let (episode, flow) = episode::run(
            start,
            &mut *self.arena,
            self.plan.config.sensor,
            &mut *self.method,
            &mut self.explorer,
            &mut ((&mut choices, &mut watch), observer),
        );
        self.progress.mistakes.add(watch.found());
        let was_optimal = choices.is_optimal(&episode);
        self.count(&episode, was_optimal);
        (episode, flow)
    }

    /// Runs all remaining episodes, until the observer wants the trial to end.
    pub fn run(&mut self, observer: &mut dyn Observer) -> ControlFlow<()> {
        while !self.is_finished() {
            self.run_episode(observer).1?;
        }
        ControlFlow::Continue(())
    }

    /// Sets up exploration, and returns how the next episode starts. Alternating episodes explore (and evolve) or
    /// exploit; all others do both.
    fn next_start(&mut self) -> Start {
        let episode = self.progress.episodes + 1;
        let settings = &self.plan.config.settings.episode;
        let turn = settings.turn_of(episode);
        let explore = turn.map_or(settings.explore, |explores| f64::from(u8::from(explores)));
        self.explorer.set_probability(explore);
        let number = match self.start_cells.count() {
            1 => 0,
            count => self.starts.below(count),
        };
        let cell = self.start_cells.nth(&self.plan.maze, number);
        Start {
            episode,
            cell: cell.expect("a checked maze has a start cell"),
            evolves: turn.unwrap_or(true),
        }
    }

    fn count(&mut self, episode: &Episode, was_optimal: bool) {
        let optimal = self.judge.is_optimal(&*self.method, &self.plan.maze);
        let progress = &mut self.progress;
        progress.episodes += 1;
        progress.steps += u64::from(episode.steps);
        progress.collisions += u64::from(episode.collisions);
        progress.chosen.add(&episode.chosen);
        progress.filter_firings += u64::from(episode.filter_firings);
        progress.imprintings += u32::from(episode.imprinted);
        progress.rule_updates = self.method.rule_updates();
        progress.reached_goal += u32::from(episode.ending == episode::Ending::Goal);
        progress.most_rules = progress.most_rules.max(episode.rules);
        if progress.first_optimal_episode.is_none() {
            progress.chosen_before = progress.chosen;
        }
        progress.optimal = optimal;
        progress.optimal_episodes += u32::from(optimal);
        if optimal && progress.first_optimal_episode.is_none() {
            progress.first_optimal_episode = Some(episode.episode);
            progress.first_optimal_env_steps = Some(progress.steps);
        }
        if episode.ending == episode::Ending::Goal {
            let best = progress
                .best_steps
                .map_or(episode.steps, |b| b.min(episode.steps));
            progress.best_steps = Some(best);
        }
        if was_optimal {
            let first = &mut progress.first_executed_optimal_episode;
            first.get_or_insert(episode.episode);
        }
    }

    /// Returns the present policy without exploration.
    pub fn policy(&self) -> PolicyMap {
        PolicyMap::of(&*self.method, self.plan.config.sensor, &self.plan.maze)
    }

    /// Returns the cells of the greedy path from the start, assuming exact moves, with ties broken by the first best
    /// action. The path ends at a goal, or where the policy makes no more progress. `None` if episodes start
    /// anywhere.
    pub fn greedy_path(&self) -> Option<Vec<Cell>> {
        let maze = &self.plan.maze;
        Some(self.policy().greedy_path(maze, maze.start()?))
    }

    /// Returns the figures so far.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Returns the plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the shortest paths of the maze.
    pub fn paths(&self) -> &Paths {
        self.judge.paths()
    }

    /// Returns the learner.
    pub fn method(&self) -> &dyn Agent {
        &*self.method
    }
}
