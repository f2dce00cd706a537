//! Shortest paths from every cell to the nearest goal.

use std::collections::VecDeque;

use super::maze::{Cell, Maze};
use xcs::Action;

/// In place of a distance: the cell is free, but no way leads from it to a goal.
const CUT_OFF: u32 = u32::MAX;
/// In place of a distance: the cell is a wall. One look-up then tells all about a cell, which
/// counts in mazes larger than the cache.
const WALL: u32 = u32::MAX - 1;

/// The length of the shortest path from each cell to the nearest goal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Paths {
    /// By cell index; or [`CUT_OFF`] or [`WALL`].
    distance: Vec<u32>,
}

impl Paths {
    /// Breadth-first search from the goals outward (moves can be reversed in every world).
    pub fn new(maze: &Maze) -> Self {
        let blank = |&wall: &bool| if wall { WALL } else { CUT_OFF };
        let mut distance: Vec<u32> = maze.walls.iter().map(blank).collect();
        let mut queue: VecDeque<Cell> = maze.goals().iter().copied().collect();
        queue
            .iter()
            .for_each(|&goal| distance[maze.index(goal)] = 0);
        while let Some(cell) = queue.pop_front() {
            let beyond = distance[maze.index(cell)] + 1;
            for &direction in maze.moves().directions() {
                let Some(next) = maze.neighbour(cell, direction) else {
                    continue;
                };
                let known = &mut distance[maze.index(next)];
                if *known == CUT_OFF {
                    *known = beyond;
                    queue.push_back(next);
                }
            }
        }
        Self { distance }
    }

    /// Steps from a cell to the nearest goal; `None` for walls and cells that reach no goal.
    pub fn distance(&self, maze: &Maze, cell: Cell) -> Option<u32> {
        if cell.col >= maze.width() || cell.row >= maze.height() {
            return None;
        }
        Some(self.distance[maze.index(cell)]).filter(|&steps| steps < WALL)
    }

    /// The cell that an action leads to, if that is a step along a shortest path.
    pub fn successor(&self, maze: &Maze, cell: Cell, action: Action) -> Option<Cell> {
        let next = maze.step(cell, maze.direction(action)?)?;
        let nearer = self.distance(maze, next)? + 1 == self.distance(maze, cell)?;
        nearer.then_some(next)
    }

    /// The number of different shortest paths from a cell to a goal, as far as a `u64` counts.
    pub fn count_from(&self, maze: &Maze, start: Cell) -> u64 {
        let Some(distance) = self.distance(maze, start) else {
            return 0;
        };
        // By cell: in how many ways one can get there from the start.
        let mut ways = vec![(start, 1_u64)];
        for left in (0..distance).rev() {
            ways = self.ways_onward(maze, &ways, left);
        }
        ways.iter().fold(0, |sum, way| sum.saturating_add(way.1))
    }

    /// The ways to the cells that are `left` steps from a goal, from those one step before.
    fn ways_onward(&self, maze: &Maze, ways: &[(Cell, u64)], left: u32) -> Vec<(Cell, u64)> {
        let directions = maze.moves().directions();
        let mut onward: Vec<(Cell, u64)> = ways
            .iter()
            .flat_map(|&(cell, count)| {
                directions
                    .iter()
                    .filter_map(move |&direction| maze.neighbour(cell, direction))
                    .filter(|&next| self.distance[maze.index(next)] == left)
                    .map(move |next| (next, count))
            })
            .collect();
        onward.sort_unstable_by_key(|way| way.0);
        onward.dedup_by(|later, kept| {
            let same = later.0 == kept.0;
            if same {
                kept.1 = kept.1.saturating_add(later.1);
            }
            same
        });
        onward
    }
}
