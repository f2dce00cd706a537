//! An observer that looks at what was learned after some episodes.

use std::ops::ControlFlow;

use super::policy_picture::{Look, Moment, PolicyPicture};
use crate::arena::View;
use crate::episode::{AfterEpisode, Ending, Episode, Observer, PolicyMap, Step};
use crate::trial::{Judge, Plan};
use crate::world::Cell;

/// The episodes after which a camera looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stages {
    /// One episode. The camera ends the run after it.
    After(u32),
    /// The first episode, the next one that reaches the goal, and the last. The camera does not end the run.
    OfLearning {
        /// The number of the last episode.
        last: u32,
    },
}

/// An observer that looks at what was learned after some episodes.
pub(crate) struct Camera {
    stages: Stages,
    judge: Judge,
    /// The cells that were visited in the present episode, the start first.
    visited: Vec<Cell>,
    moments: Vec<Moment>,
    has_seen_success: bool,
}

impl Camera {
    /// Creates a camera for the run of a plan.
    pub(crate) fn new(stages: Stages, plan: &Plan) -> Self {
        let Plan { maze, config } = plan;
        Self {
            stages,
            judge: Judge::new(maze, config.sensor, config.settings.arena.slip),
            visited: Vec::new(),
            moments: Vec::new(),
            has_seen_success: false,
        }
    }

    /// Returns the picture of all stages of the run of `plan` that were seen.
    pub(crate) fn picture(self, plan: &Plan, look: Look) -> PolicyPicture {
        let config = &plan.config;
        let (world, method) = (plan.maze.name(), config.method.name());
        let (arena, seed) = (config.arena.name(), config.seed);
        PolicyPicture {
            maze: plan.maze.clone(),
            title: format!("{world}: {method} on {arena}, seed {seed}"),
            paths: self.judge.paths().clone(),
            look,
            moments: self.moments,
        }
    }

    fn looks_after(&mut self, episode: &Episode) -> bool {
        match self.stages {
            Stages::After(number) => episode.episode == number,
            Stages::OfLearning { last } => {
                let is_first = episode.episode == 1;
                let is_success = episode.ending == Ending::Goal && !is_first;
                let is_first_success =
                    is_success && !std::mem::replace(&mut self.has_seen_success, true);
                is_first || is_first_success || episode.episode == last
            }
        }
    }
}

impl Observer for Camera {
    fn began(&mut self, _: u32, view: &View<'_>) {
        self.visited = vec![view.cell];
    }

    fn stepped(&mut self, step: &Step<'_>) {
        self.visited.push(step.view.cell);
    }

    fn ended(&mut self, episode: &Episode, after: &AfterEpisode<'_>) -> ControlFlow<()> {
        if !self.looks_after(episode) {
            return ControlFlow::Continue(());
        }
        let (method, sensor, maze) = (after.method, after.sensor, after.view.maze);
        let policy = PolicyMap::of(method, sensor, maze);
        let from = self.visited[0];
        self.moments.push(Moment {
            episode: *episode,
            greedy_path: policy.greedy_path(maze, from),
            policy,
            optimal: self.judge.is_optimal(method, maze),
            visited: std::mem::take(&mut self.visited),
        });
        match self.stages {
            Stages::After(_) => ControlFlow::Break(()),
            Stages::OfLearning { .. } => ControlFlow::Continue(()),
        }
    }
}
