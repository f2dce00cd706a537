//! Simulation of the greedy policy from a cell, with exact moves.

use crate::agent::{Agent, Frozen};
use xcs::Action;
use xcscr_robot::arena::Outcome;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, Maze};

/// A simulated episode. A policy with a map updates its state estimate.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    policy: Frozen,
    cell: Cell,
    /// The cells whose reward was collected.
    collected: Vec<Cell>,
}

impl Drive {
    /// Begins an episode in a cell.
    pub(super) fn new(policy: Frozen, start: Cell) -> Self {
        Self {
            policy,
            cell: start,
            collected: Vec::new(),
        }
    }

    /// Returns the present cell.
    pub(super) fn cell(&self) -> Cell {
        self.cell
    }

    /// Returns the best actions here; empty if there are no values.
    pub(super) fn best_actions(&mut self, maze: &Maze, sensor: Sensor) -> Vec<Action> {
        let percept = sensor.perceive_at(maze, self.cell);
        let values = self.policy.observe(&percept);
        match values.greatest() {
            Some(_) => values.best_actions().collect(),
            None => Vec::new(),
        }
    }

    /// Takes an action.
    pub(super) fn take(&mut self, maze: &Maze, action: Action) {
        let direction = maze.direction(action);
        let next = direction.and_then(|direction| maze.step(self.cell, direction));
        let outcome = match next {
            None => Outcome::Collided { impulse_ns: None },
            Some(next) if maze.is_goal(next) => Outcome::ReachedGoal,
            Some(next) => self.enter(maze, next),
        };
        self.policy.update(action, outcome);
        self.cell = next.unwrap_or(self.cell);
    }

    /// Returns the outcome of entering a cell.
    fn enter(&mut self, maze: &Maze, cell: Cell) -> Outcome {
        match maze.auxiliary_reward(cell) {
            Some(reward) if !self.collected.contains(&cell) => {
                self.collected.push(cell);
                Outcome::FoundReward { reward }
            }
            _ => Outcome::Moved,
        }
    }
}

/// Returns the cells of the greedy path from `start`, with ties broken by the first best action. A
/// cell is repeated for each step that ends at a wall. The path ends at a goal, at the
/// step-threshold, in a cell without values, or in a cell that is never left again.
pub(super) fn greedy_path(maze: &Maze, sensor: Sensor, policy: Frozen, start: Cell) -> Vec<Cell> {
    let limit = policy.step_threshold() as usize;
    let mut drive = Drive::new(policy, start);
    let mut path = vec![start];
    while path.len() <= limit && !maze.is_goal(drive.cell) {
        let Some(&best) = drive.best_actions(maze, sensor).first() else {
            break;
        };
        drive.take(maze, best);
        path.push(drive.cell);
    }
    while path.ends_with(&[drive.cell, drive.cell]) {
        path.pop();
    }
    path
}
