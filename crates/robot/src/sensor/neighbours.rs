//! The eight surrounding cells, two bits each.

use crate::world::{Cell, Content, Maze};
use xcs::Percept;

/// Two bits for each of eight cells.
pub const WIDTH: usize = 16;

/// Returns the percept of a cell, clockwise from north. Cells beyond a border look like walls.
pub fn percept(maze: &Maze, cell: Cell) -> Percept {
    // The lowest bit is printed first.
    let states = maze.around(cell).map(|content| match content {
        Content::Wall => 0b10,
        Content::Goal => 0b11,
        Content::Free => 0b00,
    });
    let word = states.iter().rev().fold(0, |word, bits| word << 2 | bits);
    Percept::from_word(word, WIDTH)
}
