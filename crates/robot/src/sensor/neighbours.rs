//! The eight surrounding cells, two bits each.

use crate::world::{Cell, Content, Maze};
use xcs::Percept;

/// Two bits for each of eight cells.
pub const WIDTH: usize = 16;

/// Clockwise from north; what lies beyond a border looks like a wall.
pub fn percept(maze: &Maze, cell: Cell) -> Percept {
    // The bit that is printed first is the lowest.
    let letters = maze.around(cell).map(|content| match content {
        Content::Wall => 0b10,
        Content::Goal => 0b11,
        Content::Free => 0b00,
    });
    let word = letters.iter().rev().fold(0, |word, bits| word << 2 | bits);
    Percept::from_word(word, WIDTH)
}
