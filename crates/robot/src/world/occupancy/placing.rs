//! Aligns the grid with a map.

use super::MapError;
use super::cells::{Cells, Layout, ROUNDING};
use super::raster::{Raster, Sums};

/// The requested grid.
pub(super) struct Wanted<'a> {
    pub cell_m: Option<f64>,
    /// The edge of a cell in pixels.
    pub cell_px: f64,
    pub start_m: Option<[f64; 2]>,
    pub goal_m: [f64; 2],
    pub offset_m: Option<[f64; 2]>,
    /// Returns the tolerated number of occupied pixels in a free cell of so many pixels.
    pub tolerated: &'a dyn Fn(usize) -> usize,
}

/// A grid aligned with a map, with start and goal.
pub(super) struct Placed<'a> {
    pub cells: Cells<'a>,
    pub start: Option<usize>,
    pub goal: usize,
    /// For each cell: true if it can reach the goal.
    pub reached: Vec<bool>,
}

impl<'a> Placed<'a> {
    /// Shifts the grid as requested, or to the offset with the most passages between cells that
    /// reach the goal. Among equal shifts the first one is taken.
    pub fn find(wanted: &Wanted<'_>, raster: &'a Raster<'a>) -> Result<Self, MapError> {
        let sums = Sums::new(raster);
        let place = |offset_px| Self::at(wanted, raster, &sums, offset_px);
        if let Some(offset_m) = wanted.offset_m {
            return place(offset_m.map(|metres| metres / raster.map.resolution_m));
        }
        let mut best = place([0.0, 0.0]);
        let mut score = best.as_ref().ok().map(Self::score);
        for offset_px in shifts(wanted.cell_px).skip(1) {
            let placed = place(offset_px);
            let other = placed.as_ref().ok().map(Self::score);
            if other > score {
                (best, score) = (placed, other);
            }
        }
        best
    }

    fn at(
        wanted: &Wanted<'_>,
        raster: &'a Raster<'a>,
        sums: &Sums,
        offset_px: [f64; 2],
    ) -> Result<Self, MapError> {
        let layout = Layout::new(raster.map, wanted.cell_m, offset_px)?;
        let cells = Cells::new(raster, layout, sums, wanted.tolerated);
        let goal = cells.cell_at("goal", wanted.goal_m)?;
        let start = wanted.start_m.map(|at| cells.cell_at("start", at));
        let start = start.transpose()?;
        let reached = cells.reached_from(goal);
        Ok(Self {
            cells,
            start,
            goal,
            reached,
        })
    }

    /// Returns whether the start reaches the goal, and the number of passages between cells that
    /// do.
    fn score(&self) -> (bool, usize) {
        let joined = |at: &usize, other: usize| self.reached[*at] && self.reached[other];
        let cols = self.cells.layout.cols;
        let count = self.reached.len();
        let across = (0..count).filter(|at| (at + 1) % cols > 0 && joined(at, at + 1));
        let down = (0..count.saturating_sub(cols)).filter(|at| joined(at, at + cols));
        let is_reached = self
            .start
            .is_none_or(|start| start != self.goal && self.reached[start]);
        (is_reached, across.count() + down.count())
    }
}

/// Returns all shifts to the left and downward by less than a cell, in whole pixels. Larger cells
/// have more shifts, but each shift has fewer cells, so the time depends only on the size of the
/// map.
fn shifts(cell_px: f64) -> impl Iterator<Item = [f64; 2]> {
    let count = (cell_px - ROUNDING).ceil() as u32;
    let along = move || (0..count).map(|number| -f64::from(number));
    along().flat_map(move |down| along().map(move |left| [left, down]))
}
