//! Whether a greedy policy is globally optimal, and which way it takes.

use super::bounds::Bounds;
use super::drive::greedy_path;
use super::greedy::expected_steps;
use crate::agent::{Agent, Frozen};
use crate::episode::{FaultFinder, PolicyMap};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, Maze, Paths};

/// Judges the policy of one learner in one maze, again and again.
pub struct Judge {
    sensor: Sensor,
    paths: Paths,
    faults: FaultFinder,
}

impl Judge {
    /// For a robot that perceives with `sensor`, and whose moves slip with probability `slip`.
    pub fn new(maze: &Maze, sensor: Sensor, slip: f64) -> Self {
        Self {
            sensor,
            paths: Paths::with_slip(maze, slip),
            faults: FaultFinder::default(),
        }
    }

    /// The shortest paths of the maze.
    pub fn paths(&self) -> &Paths {
        &self.paths
    }

    /// Is the greedy policy globally optimal now? Of a method that remembers nothing, every best
    /// action must follow a shortest path. A method that remembers must take no more steps from
    /// all starts together than one who knows the world, but not where the episode began
    /// ([`Bounds::belief`]), on average over all ways that ties leave open; where moves slip, or
    /// that bound is unknown, it counts as not optimal.
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

    /// The cells through which the greedy policy goes from `start` where moves are exact, the first
    /// of the best actions on ties: to a goal, or to where it gets no further. `policy` is what the
    /// method has learned, by cell.
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

/// How many steps a path takes to a goal; `None` when it ends elsewhere.
pub fn steps_to_goal(path: &[Cell], maze: &Maze) -> Option<u32> {
    let arrives = path.last().is_some_and(|&cell| maze.is_goal(cell));
    arrives.then(|| path.len() as u32 - 1)
}

/// The method as one that no longer learns.
fn frozen(method: &dyn Agent, maze: &Maze) -> Frozen {
    let limit = method.step_threshold();
    Frozen::new(method.knowledge(), maze.action_count(), limit)
}
