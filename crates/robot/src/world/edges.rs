//! The moves of a world from a map: a robot may move between two cells if it touches nothing.

use std::sync::Arc;

use super::direction::Direction;
use super::maze::{Cell, Maze};
use super::solid::Solid;

impl Maze {
    /// Returns the radius in metres of the disc that stays clear on every move; `None` in a maze,
    /// whose walls fill their cells.
    pub fn clear_radius_m(&self) -> Option<f64> {
        self.open.is_some().then_some(self.solid.radius_m)
    }

    /// Returns true if a move to a neighbouring cell touches no wall. In a maze this is true if the
    /// neighbour is free.
    pub fn is_open(&self, cell: Cell, direction: Direction) -> bool {
        self.step(cell, direction).is_some()
    }

    /// Returns true if the walls of a map bar a move, although both cells are free.
    pub(super) fn is_barred(&self, cell: Cell, direction: Direction) -> bool {
        let open = self.open.as_ref();
        open.is_some_and(|open| open[self.index(cell)] >> (direction as u8) & 1 == 0)
    }

    /// Finds the moves on which the disc stays clear.
    pub(super) fn find_open_moves(&mut self) {
        let mut open = vec![0; self.walls.len()];
        let cells: Vec<Cell> = self.free_cells().collect();
        for cell in cells {
            for (direction, back) in opposites() {
                let Some(next) = self.neighbour(cell, direction) else {
                    continue;
                };
                let ends = [cell, next].map(|cell| self.centre_in_grid(cell));
                if !self.is_wall(next) && self.solid.is_path_clear(ends, self.solid.radius_m) {
                    open[self.index(cell)] |= 1 << direction as u8;
                    open[self.index(next)] |= 1 << back as u8;
                }
            }
        }
        self.open = Some(open.into());
    }

    /// Returns the same map for a robot that needs a disc of this radius: every cell in whose middle
    /// the disc is clear, and every move on which it stays clear. Cells that cannot reach a goal
    /// become walls. Returns `None` if start and goal are no such cells, or not connected. A maze
    /// stays as it is.
    pub fn for_robot(&self, radius_m: f64) -> Option<Self> {
        if self
            .clear_radius_m()
            .is_none_or(|clear_m| clear_m == radius_m)
        {
            return Some(self.clone());
        }
        let mut solid = (*self.solid).clone();
        solid.radius_m = radius_m;
        self.with_solid(solid)
    }

    /// Returns the same cells, start and goals among walls of another shape, with every cell and
    /// move that is clear. Cells that cannot reach a goal become walls. Returns `None` if start and
    /// goal are no such cells, or not connected.
    pub(super) fn with_solid(&self, solid: Solid) -> Option<Self> {
        let radius_m = solid.radius_m;
        let is_inner = |cell: Cell| {
            (1..self.width - 1).contains(&cell.col) && (1..self.height - 1).contains(&cell.row)
        };
        let is_free = |cell| is_inner(cell) && solid.is_clear(self.centre_in_grid(cell), radius_m);
        let walls = self.cells().map(|cell| !is_free(cell)).collect();
        let goals = self.goals.iter().copied().filter(|&goal| is_free(goal));
        let mut maze = Self {
            walls,
            goals: goals.collect(),
            solid: Arc::new(solid),
            cache: Default::default(),
            ..self.clone()
        };
        maze.find_open_moves();
        maze.close_unreachable();
        let has_start = match maze.start {
            Some(start) => !maze.is_wall(start),
            None => maze.starts().next().is_some(),
        };
        has_start.then_some(maze)
    }

    /// Turns the cells that cannot reach a goal into walls.
    fn close_unreachable(&mut self) {
        let mut walls = vec![true; self.walls.len()];
        let mut near = self.goals.clone();
        near.iter()
            .for_each(|&goal| walls[self.index(goal)] = false);
        while let Some(cell) = near.pop() {
            for &direction in self.moves.directions() {
                let next = self.step(cell, direction);
                if let Some(next) = next.filter(|&next| walls[self.index(next)]) {
                    walls[self.index(next)] = false;
                    near.push(next);
                }
            }
        }
        self.walls = walls.into();
        self.find_open_moves();
    }
}

/// Returns four of the eight directions, each with its opposite.
fn opposites() -> impl Iterator<Item = (Direction, Direction)> {
    (0..4).map(|eighth| {
        (
            Direction::CLOCKWISE[eighth],
            Direction::CLOCKWISE[eighth + 4],
        )
    })
}
