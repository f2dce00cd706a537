//! The eight cells around one.

use super::direction::Direction;
use super::maze::{Cell, Maze};

/// What is in a cell; beyond a border is a wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// A free cell.
    Free,
    /// A wall.
    Wall,
    /// A goal.
    Goal,
}

impl Maze {
    /// What is in the eight cells around one, clockwise from north.
    pub fn around(&self, cell: Cell) -> [Content; 8] {
        let is_at_border = |at: u16, size: u16| at == 0 || at + 1 >= size;
        // Edges may join, and few cells are near a goal: those are asked one by one.
        if is_at_border(cell.col, self.width)
            || is_at_border(cell.row, self.height)
            || self.has_goal_in_rows(cell.row - 1, cell.row + 1)
        {
            return Direction::CLOCKWISE.map(|direction| match self.step(cell, direction) {
                None => Content::Wall,
                Some(next) if self.is_goal(next) => Content::Goal,
                Some(_) => Content::Free,
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
            true => Content::Wall,
            false => Content::Free,
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

    /// Cell by cell, as a robot would step there.
    fn stepped(maze: &Maze, cell: Cell) -> [Content; 8] {
        Direction::CLOCKWISE.map(|direction| match maze.step(cell, direction) {
            None => Content::Wall,
            Some(next) if maze.is_goal(next) => Content::Goal,
            Some(_) => Content::Free,
        })
    }

    #[test]
    fn around_every_cell_is_what_steps_in_all_directions_lead_to() {
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
            // Control: each content was met.
            for content in [Content::Free, Content::Wall, Content::Goal] {
                assert!(found.contains(&content), "{content:?}");
            }
        }
    }
}
