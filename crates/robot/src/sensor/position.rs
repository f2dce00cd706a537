//! The robot's cell in binary.

use crate::world::{Cell, Maze};
use xcs::Percept;

/// Returns the number of bits that hold every column and every row.
pub fn width(maze: &Maze) -> usize {
    col_width(maze) + bits_for(maze.height())
}

/// Returns the number of bits that hold every column.
pub fn col_width(maze: &Maze) -> usize {
    bits_for(maze.width())
}

/// Returns the percept of a cell: column, then row, highest bit first.
pub fn percept(maze: &Maze, cell: Cell) -> Percept {
    let binary = |value: u16, width: usize| (0..width).rev().map(move |i| value >> i & 1 == 1);
    let col = binary(cell.col, bits_for(maze.width()));
    let row = binary(cell.row, bits_for(maze.height()));
    Percept::from_bits(col.chain(row)).expect("two 16-bit numbers fit into a percept")
}

/// Returns the number of bits that hold every number below `count`.
fn bits_for(count: u16) -> usize {
    (u16::BITS - count.saturating_sub(1).leading_zeros()).max(1) as usize
}
