//! The eight cells around a cell.

use serde::Serialize;
use strum::VariantArray;

use super::direction::Direction;
use super::maze::{Cell, Maze};

/// The state of a cell; cells beyond a border are walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, VariantArray)]
#[serde(rename_all = "kebab-case")]
pub enum CellState {
    /// A free cell.
    Free,
    /// A wall.
    Wall,
    /// A goal.
    Goal,
}

impl Maze {
    /// Returns the states of the eight cells around a cell, clockwise from north.
    pub fn around(&self, cell: Cell) -> [CellState; 8] {
        let is_at_border = |at: u16, size: u16| at == 0 || at + 1 >= size;
        // Edges may join, walls of a map may bar moves, and only few cells are near a goal: these
        // cells are looked up one by one.
        if self.is_from_map()
            || is_at_border(cell.col, self.width)
            || is_at_border(cell.row, self.height)
            || self.has_goal_in_rows(cell.row - 1, cell.row + 1)
        {
            return Direction::CLOCKWISE.map(|direction| match self.step(cell, direction) {
                None => CellState::Wall,
                Some(next) if self.is_goal(next) => CellState::Goal,
                Some(_) => CellState::Free,
            });
        }
        let (at, width) = (self.index(cell), usize::from(self.width));
        let (north, south) = (at - width, at + width);
        let clockwise = [
            north,
            north + 1,
            at + 1,
            south + 1,
            south,
            south - 1,
            at - 1,
            north - 1,
        ];
        clockwise.map(|at| match self.walls[at] {
            true => CellState::Wall,
            false => CellState::Free,
        })
    }

    fn has_goal_in_rows(&self, first: u16, last: u16) -> bool {
        let next = self.goals.partition_point(|goal| goal.row < first);
        self.goals.get(next).is_some_and(|goal| goal.row <= last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks up cell by cell, as a robot would step there.
    fn stepped(maze: &Maze, cell: Cell) -> [CellState; 8] {
        Direction::CLOCKWISE.map(|direction| match maze.step(cell, direction) {
            None => CellState::Wall,
            Some(next) if maze.is_goal(next) => CellState::Goal,
            Some(_) => CellState::Free,
        })
    }

    #[test]
    fn surroundings_match_the_steps_in_all_directions() {
        let rows = [
            "########", "#.#...##", "#.....##", "#S.#...#", "#...#..#", "#..G#..#", "########",
        ];
        let closed = format!(r#"{{ "rows": {rows:?} }}"#);
        let rows = [".#...", "..#..", "G....", ".....", ".#.#."];
        let joined = format!(r#"{{ "wrap": true, "rows": {rows:?} }}"#);
        for text in [closed, joined] {
            let maze = Maze::from_json(text.as_bytes(), "m").unwrap();
            let mut found = Vec::new();
            for cell in maze.cells() {
                let around = maze.around(cell);
                assert_eq!(around, stepped(&maze, cell), "{cell:?}");
                found.extend(around);
            }
            // Control: every content occurs.
            for content in [CellState::Free, CellState::Wall, CellState::Goal] {
                assert!(found.contains(&content), "{content:?}");
            }
        }
    }
}
