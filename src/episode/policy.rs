//! The greedy policy, and whether it is globally optimal.

use crate::agent::Agent;
use crate::sensor::Sensor;
use crate::world::{Cell, Maze, Paths};
use xcs::PredictionArray;

/// The worth of each action in each free cell of a maze, in reading order of the cells.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyMap {
    cells: Vec<(Cell, PredictionArray)>,
}

impl PolicyMap {
    /// Asks a learner what it would do in each free cell that is no goal. Changes nothing.
    pub fn of(method: &dyn Agent, sensor: Sensor, maze: &Maze) -> Self {
        let worth = |cell| (cell, method.worth(&sensor.perceive_at(maze, cell)));
        let cells = maze.free_cells().filter(|&cell| !maze.is_goal(cell));
        Self {
            cells: cells.map(worth).collect(),
        }
    }

    /// Each free cell that is no goal, with the worth of its actions.
    pub fn cells(&self) -> impl Iterator<Item = &(Cell, PredictionArray)> {
        self.cells.iter()
    }

    /// The worth of the actions in a cell; `None` for walls and goals.
    pub fn worth(&self, cell: Cell) -> Option<&PredictionArray> {
        let at = self
            .cells
            .binary_search_by_key(&(cell.row, cell.col), |(c, _)| (c.row, c.col));
        at.ok().map(|i| &self.cells[i].1)
    }

    /// Is the greedy policy globally optimal? From every start cell, every action that attains
    /// the greatest worth (all of them, on ties) must move along a shortest path to a goal.
    pub fn is_optimal(&self, maze: &Maze, paths: &Paths) -> bool {
        let worth = |cell| self.worth(cell).copied();
        fault(maze, paths, maze.start_cells(), worth).is_none()
    }

    /// The steps that the greedy policy takes from `start` to a goal, the first of the best
    /// actions on ties; `None` when it hits a wall, knows no action or walks in a circle.
    pub fn greedy_steps(&self, maze: &Maze, start: Cell) -> Option<u32> {
        let path = self.greedy_path(maze, start);
        let arrives = path.last().is_some_and(|&cell| maze.is_goal(cell));
        arrives.then(|| path.len() as u32 - 1)
    }

    /// The cells through which the greedy policy goes from `start`, the first of the best actions
    /// on ties: to a goal, or until it hits a wall, knows no action, or has taken as many steps as
    /// there are cells.
    pub fn greedy_path(&self, maze: &Maze, start: Cell) -> Vec<Cell> {
        let mut path = vec![start];
        let mut cell = start;
        while path.len() <= self.cells.len() && !maze.is_goal(cell) {
            let action = self
                .worth(cell)
                .and_then(|worth| worth.best_actions().next());
            let ahead = action.and_then(|action| maze.direction(action));
            let Some(next) = ahead.and_then(|ahead| maze.step(cell, ahead)) else {
                break;
            };
            path.push(next);
            cell = next;
        }
        path
    }
}

/// A cell in which the greedy policy of a learner is not globally optimal, in the sense of
/// [`PolicyMap::is_optimal`]; `None` when it is. Asks the learner about no more cells than it takes
/// to find the first fault, beginning with `suspect`, where a fault was before.
pub fn first_fault(
    method: &dyn Agent,
    sensor: Sensor,
    maze: &Maze,
    paths: &Paths,
    suspect: Option<Cell>,
) -> Option<Cell> {
    let mut starts = maze.start_cells();
    // Of several start cells any may come first; a single one must.
    starts.extend(suspect.filter(|_| maze.start().is_none()));
    fault(maze, paths, starts, |cell| {
        Some(method.worth(&sensor.perceive_at(maze, cell)))
    })
}

/// A cell that one gets to by the best actions (or by slipping), and in which one of these does not lead along a
/// shortest path. Begins with the last of the cells in `open`.
fn fault(
    maze: &Maze,
    paths: &Paths,
    mut open: Vec<Cell>,
    worth: impl Fn(Cell) -> Option<PredictionArray>,
) -> Option<Cell> {
    let mut seen = vec![false; usize::from(maze.width()) * usize::from(maze.height())];
    while let Some(cell) = open.pop() {
        if maze.is_goal(cell) || std::mem::replace(&mut seen[maze.index(cell)], true) {
            continue;
        }
        let Some(worth) = worth(cell).filter(|worth| worth.greatest().is_some()) else {
            return Some(cell);
        };
        for action in worth.best_actions() {
            let Some(next) = paths.successor(maze, cell, action) else {
                return Some(cell);
            };
            open.push(next);
        }
        if paths.slips() {
            let around = maze.moves().directions().iter();
            open.extend(around.filter_map(|&along| maze.step(cell, along)));
        }
    }
    None
}
