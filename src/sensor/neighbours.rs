//! The eight surrounding cells, two bits each.

use crate::world::{Cell, Direction, Maze};
use xcs::Percept;

/// Two bits for each of eight cells.
pub const WIDTH: usize = 16;

/// Clockwise from north; what lies beyond a border looks like a wall.
pub fn percept(maze: &Maze, cell: Cell) -> Percept {
    // The bit that is printed first is the lowest.
    let letters = Direction::CLOCKWISE.map(|direction| match maze.step(cell, direction) {
        None => 0b10,
        Some(next) if maze.is_goal(next) => 0b11,
        Some(_) => 0b00,
    });
    let word = letters.iter().rev().fold(0, |word, bits| word << 2 | bits);
    Percept::from_word(word, WIDTH)
}
