//! The eight surrounding cells, two bits each.

use crate::world::{Cell, CellState, Maze};
use xcs::Percept;

/// Two bits for each of eight cells.
pub const WIDTH: usize = 16;

/// Returns the percept of a cell, clockwise from north. Cells beyond a border look like walls.
pub fn percept(maze: &Maze, cell: Cell) -> Percept {
    // The lowest bit is printed first.
    let states = maze.around(cell).map(|state| match state {
        CellState::Wall => 0b10,
        CellState::Goal => 0b11,
        CellState::Free => 0b00,
    });
    let word = states.iter().rev().fold(0, |word, bits| word << 2 | bits);
    Percept::from_word(word, WIDTH)
}

/// Returns the states of the cells that the first bits of a percept show, clockwise from north.
pub fn cells(percept: &Percept) -> [CellState; 8] {
    std::array::from_fn(
        |at| match [2 * at, 2 * at + 1].map(|bit| percept.bit(bit)) {
            [true, _] => CellState::Goal,
            [_, true] => CellState::Wall,
            _ => CellState::Free,
        },
    )
}
