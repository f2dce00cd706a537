//! Global optimality of a greedy policy.

use crate::agent::Agent;
use crate::episode::FaultFinder;
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

    /// Returns true if the greedy policy is globally optimal now: every best action follows a shortest path.
    pub fn is_optimal(&mut self, method: &dyn Agent, maze: &Maze) -> bool {
        let fault = self.faults.find(method, self.sensor, maze, &self.paths);
        fault.is_none()
    }
}

/// Returns the steps of a path to a goal; `None` if it ends elsewhere.
pub fn steps_to_goal(path: &[Cell], maze: &Maze) -> Option<u32> {
    let arrives = path.last().is_some_and(|&cell| maze.is_goal(cell));
    arrives.then(|| path.len() as u32 - 1)
}
