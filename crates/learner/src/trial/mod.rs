//! One trial: a fresh learner, run for a number of episodes from one seed.

mod advice;
mod bounds;
mod checkpoint;
mod compacted;
mod demands;
mod drive;
mod evaluation;
mod greedy;
mod history;
mod judge;
mod plan;
mod readers;
mod resolve;
mod robot;
mod settings;
mod settings_error;
mod toml_text;
mod warning;
mod why;

use std::ops::{ControlFlow, RangeInclusive};

use serde::{Deserialize, Serialize};

pub use advice::{Advice, Change as AdvisedChange};
pub use bounds::{Bounds, Estimate};
pub use checkpoint::is_sealed;
pub use checkpoint::{Checkpoint, CheckpointError, seal, unseal};
pub use compacted::Compacted;
pub use demands::words_of_memory;
pub use evaluation::Evaluation;
pub use greedy::GreedySteps;
pub use history::{PredictionChange, RuleHistory};
pub use judge::{Judge, steps_to_goal};
pub use plan::{Config, Plan, PlanError};
pub use readers::{ReadBy, Reader, Scope};
pub use resolve::Resolved;
pub use resolve::{FROM_MAZE, STEP_THRESHOLD, flatten, similar, value_of};
pub use robot::{RobotError, RobotProfile};
pub use settings::Settings;
pub use settings_error::{SettingOrigin, SettingsError};
pub use toml_text::{MOST_TOML_BYTES, shortened};
pub use warning::Warning;
pub use why::{Change, WeightedRule, Why};

use crate::agent::{Agent, Chosen, Explorer};
use crate::episode::{self, BestChoices, Episode, Mistakes, Observer, PolicyMap, Watch};
use xcs::bounds::{OutOfRange, within};
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
    /// Collisions among them.
    pub collisions: u64,
    /// The first episode after which the greedy policy was globally optimal.
    pub first_optimal_episode: Option<u32>,
    /// Steps taken until then.
    pub first_optimal_env_steps: Option<u64>,
    /// The first episode that was itself optimal: as short as the shortest path, or where actions slip
    /// one in which every choice was a best one.
    pub first_executed_optimal_episode: Option<u32>,
    /// Episodes after which the greedy policy was globally optimal.
    pub optimal_episodes: u32,
    /// Is the greedy policy globally optimal now?
    pub optimal: bool,
    /// The fewest steps of an episode that reached a goal.
    pub best_steps: Option<u32>,
    /// Who chose the steps.
    #[serde(default)]
    pub chosen: Chosen,
    /// Who chose those until the greedy policy was first globally optimal.
    #[serde(default)]
    pub chosen_before: Chosen,
    /// What the senses got wrong; nothing of a robot that does not depend on them.
    #[serde(default)]
    pub mistakes: Mistakes,
    /// The most rules after an episode.
    #[serde(default)]
    pub most_rules: usize,
}

/// More simulated time than any trial takes: 36 years, in nanoseconds.
const LONGEST_NS: u64 = 1 << 60;

impl Progress {
    /// Accepts the figures that a trial of these choices can have come to.
    ///
    /// # Errors
    /// The first figure that is out of its range, with the range.
    pub fn check(&self, config: &Config) -> Result<(), OutOfRange> {
        let (done, limit) = (self.episodes, config.settings.reward.step_threshold);
        within("episodes", done, 0..=config.episodes)?;
        within("steps", self.steps, u64::from(done)..=longest(done, limit))?;
        within("collisions", self.collisions, 0..=self.steps)?;
        self.mistakes.check(self.steps)?;
        self.chosen.check(self.steps)?;
        self.chosen_before.check(self.steps)?;
        self.check_optimum(limit)?;
        self.check_retention()?;
        let executed = self.first_executed_optimal_episode;
        some_within("first_executed_optimal_episode", executed, 1..=done)?;
        some_within("best_steps", self.best_steps, 1..=limit)
    }

    /// The policy was optimal after the first optimal episode, and at most after all since then.
    fn check_retention(&self) -> Result<(), OutOfRange> {
        let since = |first: u32| 1..=self.episodes.saturating_add(1).saturating_sub(first);
        let possible = self.first_optimal_episode.map_or(0..=0, since);
        within("optimal_episodes", self.optimal_episodes, possible)
    }

    /// The share of the episodes after the first optimal one after which the greedy policy was
    /// optimal, too; `None` without any such episode.
    pub fn optimal_share_after_first(&self) -> Option<f64> {
        let after = self.episodes.checked_sub(self.first_optimal_episode?)?;
        let optimal = self.optimal_episodes.saturating_sub(1);
        (after > 0).then(|| f64::from(optimal) / f64::from(after))
    }

    /// The first optimum has an episode and a step, or neither.
    fn check_optimum(&self, limit: u32) -> Result<(), OutOfRange> {
        let (episode, steps) = (self.first_optimal_episode, self.first_optimal_env_steps);
        some_within("first_optimal_episode", episode, 1..=self.episodes)?;
        let Some((first, steps)) = episode.zip(steps) else {
            let is_without = episode.is_none() && steps.is_none() && !self.optimal;
            let refusal = || OutOfRange {
                key: "first_optimal_episode",
                value: episode.map_or("missing".to_owned(), |first| first.to_string()),
                allowed: "there if, and only if, `first_optimal_env_steps` is".to_owned(),
            };
            return is_without.then_some(()).ok_or_else(refusal);
        };
        let latest = self.steps.min(longest(first, limit));
        within("first_optimal_env_steps", steps, u64::from(first)..=latest)
    }
}

/// The most steps that so many episodes take.
fn longest(episodes: u32, limit: u32) -> u64 {
    u64::from(episodes) * u64::from(limit)
}

/// Accepts a figure that is missing, or lies in its range.
fn some_within<T: PartialOrd + std::fmt::Display>(
    key: &'static str,
    figure: Option<T>,
    range: RangeInclusive<T>,
) -> Result<(), OutOfRange> {
    figure.map_or(Ok(()), |figure| within(key, figure, range))
}

impl Plan {
    /// Runs the trial to its end, unrecorded.
    ///
    /// # Errors
    /// When the world or a setting is refused.
    pub fn run(self) -> Result<Trial, PlanError> {
        let mut trial = Trial::new(self)?;
        // Nobody listens who could break it off.
        let _ = trial.run(&mut ());
        Ok(trial)
    }
}

/// A trial in progress: run it episode by episode, or all at once.
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
    /// A trial at its beginning; its [plan](Self::plan) is [settled](Plan::settled).
    ///
    /// # Errors
    /// When the world or a setting is refused.
    pub fn new(plan: Plan) -> Result<Self, PlanError> {
        plan.check()?;
        let plan = plan.settled();
        let agent = plan.config.build_method(&plan.maze)?;
        Self::with_agent(plan, agent)
    }

    /// The same with an agent of one's own in place of the plan's method. It can be resumed from a
    /// checkpoint only if the agent knows how: see [`Agent::checkpoint`].
    ///
    /// # Errors
    /// When the world or a setting is refused.
    pub fn with_agent(plan: Plan, agent: Box<dyn Agent>) -> Result<Self, PlanError> {
        plan.check()?;
        let plan = plan.settled();
        let Plan { maze, config } = &plan;
        let exploration = Stream::new(config.seed, StreamName::Exploration);
        Ok(Self {
            judge: Judge::new(maze, config.sensor, config.settings.arena.slip),
            arena: config.build_arena(maze)?,
            method: agent,
            explorer: Explorer::new(config.settings.episode.explore, exploration),
            start_cells: Starts::new(maze),
            starts: Stream::new(config.seed, StreamName::Start),
            progress: Progress::default(),
            plan,
        })
    }

    /// The trial as it is between two episodes.
    pub fn checkpoint(&self) -> Checkpoint {
        Checkpoint {
            config: self.plan.config.clone(),
            world: self.plan.maze.to_json(),
            progress: self.progress.clone(),
            method: self.method.checkpoint(),
            arena: self.arena.lasting(),
            exploration: self.explorer.stream().clone(),
            starts: self.starts.clone(),
        }
    }

    /// The trial that a checkpoint was made of. It goes on as that one did, to the bit.
    ///
    /// # Errors
    /// When the checkpoint contradicts itself.
    pub fn resume(saved: &Checkpoint) -> Result<Self, CheckpointError> {
        let mut trial = Self::new(saved.plan()?)?;
        let Plan { maze, config } = &trial.plan;
        trial.method = trial.method.restore(&saved.method)?;
        let contradiction = |what: &str| CheckpointError::Content(what.to_owned());
        let width = config.sensor.width(maze);
        trial
            .method
            .knowledge()
            .check(width, maze.action_count())
            .map_err(|misfit| CheckpointError::Content(misfit.to_string()))?;
        let progress = saved.progress.check(config);
        progress.map_err(|fault| CheckpointError::Content(fault.to_string()))?;
        if saved.arena.time_ns > LONGEST_NS {
            return Err(contradiction("its clock is beyond the end of any trial"));
        }
        trial.arena.continue_from(&saved.arena);
        trial.explorer.resume(saved.exploration.clone());
        trial.starts = saved.starts.clone();
        trial.progress = saved.progress.clone();
        Ok(trial)
    }

    /// Is every episode done?
    pub fn is_finished(&self) -> bool {
        self.progress.episodes >= self.plan.config.episodes
    }

    /// Runs the next episode. `Break` means that an observer wants the trial to end.
    pub fn run_episode(&mut self, observer: &mut dyn Observer) -> (Episode, ControlFlow<()>) {
        let start = self.next_start();
        let number = self.progress.episodes + 1;
        self.take_turns(number);
        let mut choices = BestChoices::by(self.judge.paths());
        let mut watch = Watch::new(self.plan.config.sensor);
        let (episode, flow) = episode::run(
            number,
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

    /// Runs all episodes that are left, until an observer wants the trial to end.
    pub fn run(&mut self, observer: &mut dyn Observer) -> ControlFlow<()> {
        while !self.is_finished() {
            self.run_episode(observer).1?;
        }
        ControlFlow::Continue(())
    }

    /// Episodes that alternate explore (and evolve) or exploit; all others do both.
    fn take_turns(&mut self, number: u32) {
        let settings = &self.plan.config.settings.episode;
        let turn = settings.turn_of(number);
        let explore = turn.map_or(settings.explore, |explores| f64::from(u8::from(explores)));
        self.explorer.set_probability(explore);
        self.method.begin_episode(turn.unwrap_or(true));
    }

    fn next_start(&mut self) -> Cell {
        let number = match self.start_cells.count() {
            1 => 0,
            count => self.starts.below(count),
        };
        let start = self.start_cells.nth(&self.plan.maze, number);
        start.expect("a checked maze has a start cell")
    }

    fn count(&mut self, episode: &Episode, was_optimal: bool) {
        let optimal = self.judge.is_optimal(&*self.method, &self.plan.maze);
        let progress = &mut self.progress;
        progress.episodes += 1;
        progress.steps += u64::from(episode.steps);
        progress.collisions += u64::from(episode.collisions);
        progress.chosen.add(&episode.chosen);
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

    /// The policy that the learner would follow now, without exploring.
    pub fn policy(&self) -> PolicyMap {
        PolicyMap::of(&*self.method, self.plan.config.sensor, &self.plan.maze)
    }

    /// The cells through which the greedy policy goes from the start, the first of the best actions
    /// on ties, as if no move failed: to a goal, or to where it gets no further. `None` when episodes
    /// start anywhere.
    pub fn greedy_path(&self) -> Option<Vec<Cell>> {
        let (method, maze) = (&*self.method, &self.plan.maze);
        let start = maze.start()?;
        Some(self.judge.greedy_path(method, &self.policy(), maze, start))
    }

    /// The figures so far.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The shortest paths of the maze.
    pub fn paths(&self) -> &Paths {
        self.judge.paths()
    }

    /// The learner.
    pub fn method(&self) -> &dyn Agent {
        &*self.method
    }
}
