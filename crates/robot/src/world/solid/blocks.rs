//! Merges many solid pixels into few large blocks.

use nalgebra::Point2;

use super::Solid;

/// A block of solid pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block {
    /// The leftmost column.
    pub col: usize,
    /// The topmost row, counted from the top.
    pub row: usize,
    /// The number of columns.
    pub width: usize,
    /// The number of rows.
    pub height: usize,
}

impl Block {
    /// Returns the block's pixels as column and row.
    fn cells(self) -> impl Iterator<Item = (usize, usize)> {
        let rows = self.row..self.row + self.height;
        rows.flat_map(move |row| (self.col..self.col + self.width).map(move |col| (col, row)))
    }
}

impl Solid {
    /// Returns blocks that cover every solid pixel exactly once.
    pub fn blocks(&self) -> Vec<Block> {
        merge(self.width, self.bits.to_vec())
    }

    /// Returns the middle of a block in the grid frame, in metres.
    pub fn middle_of(&self, block: &Block) -> Point2<f64> {
        let metres = |pixels: f64| pixels * self.pixel_m;
        let (width, height) = (block.width as f64, block.height as f64);
        let top = self.height as f64 - block.row as f64;
        self.in_grid(Point2::new(
            metres(block.col as f64 + width / 2.0),
            metres(top - height / 2.0),
        ))
    }

    /// Returns width and height of a block in metres.
    pub fn size_of(&self, block: &Block) -> [f64; 2] {
        [block.width, block.height].map(|pixels| pixels as f64 * self.pixel_m)
    }
}

/// Covers every pixel of `open`, in `width` columns, with exactly one block.
///
/// Greedy in reading order: each block grows to the right as far as possible, then down. The raster
/// fixes the order of the blocks, and thus the order in which contacts are solved.
fn merge(width: usize, mut open: Vec<bool>) -> Vec<Block> {
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

/// Returns the block that starts at pixel `first` and covers only pixels that are still `open`.
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
            let open = cells[..width * height].to_vec();
            for block in merge(width, open) {
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
        let open = (0..54).map(|at| frame(at % 9, at / 9)).collect();
        assert_eq!(merge(9, open).len(), 4);
    }
}
