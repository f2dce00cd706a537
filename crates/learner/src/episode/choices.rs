//! Was an episode optimal?

use super::observer::{Ending, Episode, Observer, Step};
use xcscr_robot::arena::View;
use xcscr_robot::world::Paths;

/// Listens to one episode, and tells whether it was optimal. Without slip it is when it takes as few
/// steps as possible. Where actions slip, steps are a matter of luck: then every choice must be one
/// that value iteration on the true maze calls best.
#[derive(Debug)]
pub struct BestChoices<'a> {
    paths: &'a Paths,
    shortest: Option<u32>,
    all_best: bool,
}

impl<'a> BestChoices<'a> {
    /// Judges by the optimum that `paths` knows.
    pub fn by(paths: &'a Paths) -> Self {
        Self {
            paths,
            shortest: None,
            all_best: true,
        }
    }

    /// Was the episode that was listened to, and ended like this, optimal?
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
