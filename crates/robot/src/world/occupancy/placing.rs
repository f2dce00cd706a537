//! Where the grid lies on a map.

use super::MapError;
use super::cells::{Cells, Layout, ROUNDING};
use super::raster::{Raster, Sums};

/// Which grid is wanted.
pub(super) struct Wanted<'a> {
    pub cell_m: Option<f64>,
    /// Pixels along a cell.
    pub cell_px: f64,
    pub start_m: Option<[f64; 2]>,
    pub goal_m: [f64; 2],
    pub offset_m: Option<[f64; 2]>,
    /// How many of so many pixels of a free cell may be occupied.
    pub tolerated: &'a dyn Fn(usize) -> usize,
}

/// A grid on a map, with start and goal in it.
pub(super) struct Placed<'a> {
    pub cells: Cells<'a>,
    pub start: Option<usize>,
    pub goal: usize,
    /// By cell: can it reach the goal?
    pub reached: Vec<bool>,
}

impl<'a> Placed<'a> {
    /// Shifts the grid as it was asked for, or to where most passages between cells lead to the
    /// goal; of equal shifts the first.
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

    /// Is the start reached, and how many passages from cell to cell lead to the goal?
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

/// All shifts to the left and downward by less than a cell, in whole pixels. Larger cells have more shifts,
/// but each shift has fewer cells, so that the time depends on the size of the map alone.
fn shifts(cell_px: f64) -> impl Iterator<Item = [f64; 2]> {
    let count = (cell_px - ROUNDING).ceil() as u32;
    let along = move || (0..count).map(|number| -f64::from(number));
    along().flat_map(move |down| along().map(move |left| [left, down]))
}
