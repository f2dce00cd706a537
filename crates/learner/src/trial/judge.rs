//! Global optimality of a greedy policy, and its path.

use super::bounds::Bounds;
use super::drive::greedy_path;
use super::greedy::expected_steps;
use crate::agent::{Agent, Frozen};
use crate::episode::{FaultFinder, PolicyMap};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, Maze, Paths};

/// Checks the policy of one learner in one maze repeatedly.
pub struct Judge {
    sensor: Sensor,
    paths: Paths,
    faults: FaultFinder,
}

impl Judge {
    /// Creates a judge for a robot with `sensor` whose moves slip with probability `slip`.
    pub fn new(maze: &Maze, sensor: Sensor, slip: f64) -> Self {
        Self {
            sensor,
            paths: Paths::with_slip(maze, slip),
            faults: FaultFinder::default(),
        }
    }

    /// Returns the shortest paths of the maze.
    pub fn paths(&self) -> &Paths {
        &self.paths
    }

    /// Returns true if the greedy policy is globally optimal now. Without a map, every best action
    /// must follow a shortest path. With a map, mean steps over all starts, averaged over ties,
    /// must not exceed the unknown-start optimum ([`Bounds::belief`]). If moves slip or that
    /// optimum is unknown, a policy with a map counts as not optimal.
    pub fn is_optimal(&mut self, method: &dyn Agent, maze: &Maze) -> bool {
        if !method.remembers() {
            let fault = self.faults.find(method, self.sensor, maze, &self.paths);
            return fault.is_none();
        }
        if self.paths.slips() {
            return false;
        }
        let Some(bound) = Bounds::of_belief(maze, self.sensor) else {
            return false;
        };
        let steps = expected_steps(maze, self.sensor, &frozen(method, maze));
        steps.is_some_and(|steps| steps <= bound + 1e-9)
    }

    /// Returns the cells of the greedy path from `start` with exact moves, with ties broken by the
    /// first best action. The path ends at a goal, or where the policy makes no more progress.
    /// `policy` has the values of the method by cell.
    pub fn greedy_path(
        &self,
        method: &dyn Agent,
        policy: &PolicyMap,
        maze: &Maze,
        start: Cell,
    ) -> Vec<Cell> {
        match method.remembers() {
            true => greedy_path(maze, self.sensor, frozen(method, maze), start),
            false => policy.greedy_path(maze, start),
        }
    }
}

/// Returns the steps of a path to a goal; `None` if it ends elsewhere.
pub fn steps_to_goal(path: &[Cell], maze: &Maze) -> Option<u32> {
    let arrives = path.last().is_some_and(|&cell| maze.is_goal(cell));
    arrives.then(|| path.len() as u32 - 1)
}

/// Returns the method without learning.
fn frozen(method: &dyn Agent, maze: &Maze) -> Frozen {
    let limit = method.step_threshold();
    Frozen::new(method.knowledge(), maze.action_count(), limit)
}
