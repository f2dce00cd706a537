//! A maze under construction.

use std::collections::VecDeque;

use crate::world::direction::{Direction, Moves};
use crate::world::maze::{Cell, Maze};
use crate::world::origin::Origin;

/// A square of cells, initially all walls.
pub struct Field {
    side: u16,
    walls: Vec<bool>,
}

impl Field {
    /// Creates a solid block.
    pub fn new(side: u16) -> Self {
        Self {
            side,
            walls: vec![true; usize::from(side) * usize::from(side)],
        }
    }

    /// Returns the last column and row inside the border.
    pub fn last(&self) -> u16 {
        self.side - 2
    }

    fn index(&self, cell: Cell) -> usize {
        usize::from(cell.row) * usize::from(self.side) + usize::from(cell.col)
    }

    /// Returns true if the cell is a wall.
    pub fn is_wall(&self, col: u16, row: u16) -> bool {
        self.walls[self.index(Cell { col, row })]
    }

    /// Makes the cell free, or a wall.
    pub fn set_wall(&mut self, col: u16, row: u16, wall: bool) {
        let at = self.index(Cell { col, row });
        self.walls[at] = wall;
    }

    /// Makes all cells inside the border free.
    pub fn clear(&mut self) {
        for row in 1..=self.last() {
            (1..=self.last()).for_each(|col| self.set_wall(col, row, false));
        }
    }

    /// Converts to a maze. Cells that cannot be reached from the start become walls.
    pub fn into_maze(mut self, name: String) -> Maze {
        let start = self.largest_part_start();
        let order = self.reached_from(start);
        self.walls.fill(true);
        order
            .iter()
            .for_each(|cell| self.set_wall(cell.col, cell.row, false));
        let goal = *order.last().expect("the start itself is reached");
        let walls = self.walls.into();
        Maze {
            name,
            cell_size_m: 1.0,
            moves: Moves::Four,
            origin: Origin::default(),
            wrap: false,
            width: self.side,
            height: self.side,
            solid: Maze::solid_cells(&walls, self.side, 1.0),
            obstructed: None,
            walls,
            open: None,
            start: Some(start),
            goals: vec![goal],
            floor: None,
            cache: Default::default(),
        }
    }

    /// Returns the first cell, in reading order, of the largest connected part.
    fn largest_part_start(&self) -> Cell {
        let mut seen = vec![false; self.walls.len()];
        let mut best = (0, Cell { col: 1, row: 1 });
        for row in 1..=self.last() {
            for col in 1..=self.last() {
                let cell = Cell { col, row };
                if self.is_wall(col, row) || seen[self.index(cell)] {
                    continue;
                }
                let part = self.reached_from(cell);
                part.iter().for_each(|&cell| seen[self.index(cell)] = true);
                if part.len() > best.0 {
                    best = (part.len(), cell);
                }
            }
        }
        best.1
    }

    /// Returns the cells reachable from a free cell, in the order of their distance.
    fn reached_from(&self, start: Cell) -> Vec<Cell> {
        let mut seen = vec![false; self.walls.len()];
        seen[self.index(start)] = true;
        let mut queue = VecDeque::from([start]);
        let mut order = Vec::new();
        while let Some(cell) = queue.pop_front() {
            order.push(cell);
            for direction in Direction::MAIN {
                let (east, south) = direction.offset();
                // The border is wall, so there is a neighbour on every side.
                let next = Cell {
                    col: cell.col.wrapping_add_signed(east as i16),
                    row: cell.row.wrapping_add_signed(south as i16),
                };
                let at = self.index(next);
                if !self.walls[at] && !std::mem::replace(&mut seen[at], true) {
                    queue.push_back(next);
                }
            }
        }
        order
    }
}
