//! The greedy policy, and whether it is globally optimal.

use crate::reward::RewardMethod;
use crate::sensor::Sensor;
use crate::world::{Cell, Maze, Paths};
use crate::xcs::PredictionArray;

/// The worth of each action in each free cell of a maze, in reading order of the cells.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyMap {
    cells: Vec<(Cell, PredictionArray)>,
}

impl PolicyMap {
    /// Asks a learner what it would do in each free cell that is no goal. Changes nothing.
    pub fn of(method: &dyn RewardMethod, sensor: Sensor, maze: &Maze) -> Self {
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
        only_shortest_paths(maze, paths, &maze.start_cells(), |cell| {
            self.worth(cell).copied()
        })
    }

    /// The steps that the greedy policy takes from `start` to a goal, the first of the best
    /// actions on ties; `None` when it hits a wall, knows no action or walks in a circle.
    pub fn greedy_steps(&self, maze: &Maze, start: Cell) -> Option<u32> {
        let mut cell = start;
        for step in 0..=self.cells.len() as u32 {
            if maze.is_goal(cell) {
                return Some(step);
            }
            let action = self.worth(cell)?.best_actions().next()?;
            cell = maze.step(cell, maze.direction(action)?)?;
        }
        None
    }
}

/// What [`PolicyMap::is_optimal`] says of a learner, without asking it about more cells than it
/// takes to find the first fault; `starts` are the start cells of the maze.
pub fn is_optimal(
    method: &dyn RewardMethod,
    sensor: Sensor,
    maze: &Maze,
    paths: &Paths,
    starts: &[Cell],
) -> bool {
    only_shortest_paths(maze, paths, starts, |cell| {
        Some(method.worth(&sensor.perceive_at(maze, cell)))
    })
}

/// Do the best actions lead along shortest paths wherever one gets to by them?
fn only_shortest_paths(
    maze: &Maze,
    paths: &Paths,
    starts: &[Cell],
    worth: impl Fn(Cell) -> Option<PredictionArray>,
) -> bool {
    let mut open = starts.to_vec();
    let mut seen = vec![false; usize::from(maze.width()) * usize::from(maze.height())];
    while let Some(cell) = open.pop() {
        if maze.is_goal(cell) || std::mem::replace(&mut seen[maze.index(cell)], true) {
            continue;
        }
        let Some(worth) = worth(cell).filter(|worth| worth.greatest().is_some()) else {
            return false;
        };
        for action in worth.best_actions() {
            let Some(next) = paths.successor(maze, cell, action) else {
                return false;
            };
            open.push(next);
        }
    }
    true
}
