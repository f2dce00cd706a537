//! The optimality of one episode.

use super::observer::{Ending, Episode, Observer, Step};
use xcscr_robot::arena::View;
use xcscr_robot::world::Paths;

/// An observer that determines whether one episode is optimal. Without slip, an optimal episode
/// takes the minimum number of steps. With slip, the number of steps depends on chance, so every
/// choice must be a best action of value iteration on the true maze.
#[derive(Debug)]
pub struct BestChoices<'a> {
    paths: &'a Paths,
    shortest: Option<u32>,
    all_best: bool,
}

impl<'a> BestChoices<'a> {
    /// Creates an observer that compares with the optimum of `paths`.
    pub fn by(paths: &'a Paths) -> Self {
        Self {
            paths,
            shortest: None,
            all_best: true,
        }
    }

    /// Returns true if the observed episode with these figures was optimal.
    pub fn is_optimal(&self, episode: &Episode) -> bool {
        let is_best = match self.paths.slips() {
            true => self.all_best,
            false => self.shortest == Some(episode.steps),
        };
        is_best && episode.ending == Ending::Goal
    }
}

impl Observer for BestChoices<'_> {
    fn began(&mut self, _: u32, view: &View<'_>) {
        self.shortest = self.paths.distance(view.maze, view.cell);
        self.all_best = true;
    }

    fn stepped(&mut self, step: &Step<'_>) {
        let next = self.paths.successor(step.view.maze, step.cell, step.action);
        self.all_best &= next.is_some();
    }
}
