//! The greedy policy followed from a cell, where moves are exact.

use crate::agent::{Agent, Frozen};
use xcs::Action;
use xcscr_robot::arena::Outcome;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, Maze};

/// An episode that is followed: whoever remembers goes on as what happened tells.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    policy: Frozen,
    cell: Cell,
    /// The cells that have paid.
    spent: Vec<Cell>,
}

impl Drive {
    /// Begins in a cell.
    pub(super) fn new(policy: Frozen, start: Cell) -> Self {
        Self {
            policy,
            cell: start,
            spent: Vec::new(),
        }
    }

    /// Where it is.
    pub(super) fn cell(&self) -> Cell {
        self.cell
    }

    /// What the policy would do here; nothing where it knows nothing.
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
            Some(next) => self.found(maze, next),
        };
        self.policy.update(action, outcome);
        self.cell = next.unwrap_or(self.cell);
    }

    /// What coming into a cell brings.
    fn found(&mut self, maze: &Maze, cell: Cell) -> Outcome {
        match maze.auxiliary_reward(cell) {
            Some(reward) if !self.spent.contains(&cell) => {
                self.spent.push(cell);
                Outcome::FoundReward { reward }
            }
            _ => Outcome::Moved,
        }
    }
}

/// The cells through which a policy goes from `start`, the first of the best actions on ties; a cell
/// comes again for each step that ends at a wall. It ends at a goal, at the step-threshold, where
/// nothing is known, or in the cell that is not left any more.
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
