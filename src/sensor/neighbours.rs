//! The eight surrounding cells, two bits each.

use crate::signal::Percept;
use crate::world::{Cell, Direction, Maze};

/// Two bits for each of eight cells.
pub const WIDTH: usize = 16;

/// Clockwise from north; what lies beyond a border looks like a wall.
pub fn percept(maze: &Maze, cell: Cell) -> Percept {
    let bits =
        Direction::CLOCKWISE
            .into_iter()
            .flat_map(|direction| match maze.step(cell, direction) {
                None => [false, true],
                Some(next) if maze.is_goal(next) => [true, true],
                Some(_) => [false, false],
            });
    Percept::from_bits(bits).expect("16 bits fit into a percept")
}
