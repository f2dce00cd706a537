//! Merges many wall cells into few large blocks.

/// A block of wall cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Block {
    /// The westernmost column.
    pub col: usize,
    /// The northernmost row.
    pub row: usize,
    /// The number of columns.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
}

impl Block {
    /// Returns the block's cells as column and row.
    fn cells(self) -> impl Iterator<Item = (usize, usize)> {
        let rows = self.row..self.row + self.height;
        rows.flat_map(move |row| (self.col..self.col + self.width).map(move |col| (col, row)))
    }
}

/// Covers every wall cell of a `width` x `height` grid with exactly one block.
///
/// Greedy in reading order: each block grows east as far as possible, then south. The grid fixes
/// the order of the blocks, and thus the order in which contacts are solved.
pub(super) fn merge(
    width: usize,
    height: usize,
    is_wall: impl Fn(usize, usize) -> bool,
) -> Vec<Block> {
    let mut open: Vec<bool> = (0..width * height)
        .map(|i| is_wall(i % width, i / width))
        .collect();
    let mut blocks = Vec::new();
    for first in 0..open.len() {
        if !open[first] {
            continue;
        }
        let block = grow(&open, width, first);
        for (col, row) in block.cells() {
            open[row * width + col] = false;
        }
        blocks.push(block);
    }
    blocks
}

/// Returns the block that starts at cell `first` and covers only cells that are still `open`.
fn grow(open: &[bool], width: usize, first: usize) -> Block {
    let (col, row) = (first % width, first / width);
    let run = |row: usize| open[row * width + col..(row + 1) * width].iter();
    let across = run(row).take_while(|&&wall| wall).count();
    let down = (row..open.len() / width)
        .take_while(|&row| run(row).take(across).all(|&wall| wall))
        .count();
    Block {
        col,
        row,
        width: across,
        height: down,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn blocks_cover_each_wall_once_and_nothing_else(
            width in 1_usize..12,
            cells in prop::collection::vec(any::<bool>(), 1..120),
        ) {
            let height = cells.len() / width;
            let wall = |col: usize, row: usize| cells[row * width + col];
            let mut covered = vec![0; width * height];
            for block in merge(width, height, wall) {
                block.cells().for_each(|(col, row)| covered[row * width + col] += 1);
            }
            for (i, &count) in covered.iter().enumerate() {
                let walls = i32::from(wall(i % width, i / width));
                prop_assert_eq!(count, walls, "cell {} of width {}", i, width);
            }
        }
    }

    #[test]
    fn a_frame_needs_four_blocks() {
        let frame = |col, row| col == 0 || row == 0 || col == 8 || row == 5;
        assert_eq!(merge(9, 6, frame).len(), 4);
    }
}
