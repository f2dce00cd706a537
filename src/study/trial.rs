//! One trial: a fresh learner, run for a number of episodes from one seed.

use std::ops::ControlFlow;

use serde::{Deserialize, Serialize};

use super::settings::Settings;
use crate::arena::{Arena, GridArena, PhysicsArena, PhysicsError};
use crate::bounds::OutOfRange;
use crate::episode::{self, Episode, Explorer, Observer, PolicyMap};
use crate::random::{Stream, StreamName};
use crate::reward::{Method, RewardMethod};
use crate::sensor::Sensor;
use crate::world::{Cell, Maze, Paths};

/// Which arena a trial runs in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ArenaKind {
    /// The robot drives in simulated physics.
    Physics,
    /// A move is a step from cell to cell.
    Grid,
}

impl ArenaKind {
    /// All arenas.
    pub const ALL: [Self; 2] = [Self::Physics, Self::Grid];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Physics => "physics",
            Self::Grid => "grid",
        }
    }

    /// An arena of this kind around a maze.
    pub fn build(
        self,
        maze: Maze,
        settings: &Settings,
        seed: u64,
    ) -> Result<Box<dyn Arena>, PhysicsError> {
        Ok(match self {
            Self::Grid => Box::new(GridArena::new(maze)),
            Self::Physics => {
                let noise = Stream::new(seed, StreamName::Physics);
                Box::new(PhysicsArena::new(maze, settings.physics.clone(), noise)?)
            }
        })
    }
}

/// What a trial is: the same plan gives the same bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The world.
    pub maze: Maze,
    /// The reward method.
    pub method: Method,
    /// The arena.
    pub arena: ArenaKind,
    /// The percept.
    pub sensor: Sensor,
    /// The number of episodes.
    pub episodes: u32,
    /// The root seed of all random streams.
    pub seed: u64,
    /// All settings.
    pub settings: Settings,
}

/// Why a trial cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// A setting lies outside of its range.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// The physics arena refuses the world.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
}

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
    /// The first episode that was itself as short as the shortest path.
    pub first_executed_optimal_episode: Option<u32>,
    /// Is the greedy policy globally optimal now?
    pub optimal: bool,
    /// The fewest steps of an episode that reached a goal.
    pub best_steps: Option<u32>,
}

/// A trial in progress: run it episode by episode, or all at once.
pub struct Trial {
    plan: Plan,
    paths: Paths,
    arena: Box<dyn Arena>,
    method: Box<dyn RewardMethod>,
    explorer: Explorer,
    starts: Stream,
    progress: Progress,
}

impl Trial {
    /// A trial at its beginning.
    pub fn new(plan: Plan) -> Result<Self, PlanError> {
        plan.settings.check()?;
        let Settings {
            xcs,
            reward,
            episode,
            ..
        } = plan.settings.clone();
        let explorer = Stream::new(plan.seed, StreamName::Exploration);
        Ok(Self {
            paths: Paths::new(&plan.maze),
            arena: plan
                .arena
                .build(plan.maze.clone(), &plan.settings, plan.seed)?,
            method: plan
                .method
                .build(plan.maze.action_count(), xcs, reward, plan.seed),
            explorer: Explorer::new(episode.explore, explorer),
            starts: Stream::new(plan.seed, StreamName::Start),
            progress: Progress::default(),
            plan,
        })
    }

    /// Runs the next episode. `Break` means that an observer wants the trial to end.
    pub fn run_episode(&mut self, observer: &mut dyn Observer) -> (Episode, ControlFlow<()>) {
        let start = self.next_start();
        let (episode, flow) = episode::run(
            self.progress.episodes + 1,
            start,
            &mut *self.arena,
            self.plan.sensor,
            &mut *self.method,
            &mut self.explorer,
            observer,
        );
        self.count(&episode, start);
        (episode, flow)
    }

    /// Runs all episodes that are left, until an observer wants the trial to end.
    pub fn run(&mut self, observer: &mut dyn Observer) -> ControlFlow<()> {
        while self.progress.episodes < self.plan.episodes {
            self.run_episode(observer).1?;
        }
        ControlFlow::Continue(())
    }

    fn next_start(&mut self) -> Cell {
        let cells = self.plan.maze.start_cells();
        match cells[..] {
            [only] => only,
            _ => *self
                .starts
                .choose(&cells)
                .expect("a checked maze has a start cell"),
        }
    }

    fn count(&mut self, episode: &Episode, start: Cell) {
        let optimal = self.policy().is_optimal(&self.plan.maze, &self.paths);
        let shortest = self.paths.distance(&self.plan.maze, start);
        let progress = &mut self.progress;
        progress.episodes += 1;
        progress.steps += u64::from(episode.steps);
        progress.collisions += u64::from(episode.collisions);
        progress.optimal = optimal;
        if optimal && progress.first_optimal_episode.is_none() {
            progress.first_optimal_episode = Some(episode.episode);
            progress.first_optimal_env_steps = Some(progress.steps);
        }
        if episode.ending == episode::Ending::Goal {
            let best = progress
                .best_steps
                .map_or(episode.steps, |b| b.min(episode.steps));
            progress.best_steps = Some(best);
            if Some(episode.steps) == shortest {
                progress
                    .first_executed_optimal_episode
                    .get_or_insert(episode.episode);
            }
        }
    }

    /// The policy that the learner would follow now.
    pub fn policy(&self) -> PolicyMap {
        PolicyMap::of(&*self.method, self.plan.sensor, &self.plan.maze)
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
        &self.paths
    }

    /// The learner.
    pub fn method(&self) -> &dyn RewardMethod {
        &*self.method
    }
}
