//! Aligns the grid with a map.

use super::MapError;
use super::cells::{Cells, Layout};
use super::raster::Raster;
use crate::world::Solid;

/// The requested grid.
pub(super) struct Wanted {
    pub cell_m: f64,
    pub yaw_rad: f64,
    pub start_m: Option<[f64; 2]>,
    pub goal_m: [f64; 2],
    pub offset_m: Option<[f64; 2]>,
}

/// A grid aligned with a map, with start and goal.
pub(super) struct Placed<'a> {
    pub cells: Cells<'a>,
    pub start: Option<usize>,
    pub goal: usize,
    /// For each cell: true if it can reach the goal.
    pub reached: Vec<bool>,
    /// The number of moves between these cells.
    moves: usize,
}

impl<'a> Placed<'a> {
    /// Shifts the grid as requested, or to the offset with the most moves between cells that reach
    /// the goal. Among equal shifts the first one is taken.
    pub fn find(
        wanted: &Wanted,
        raster: &'a Raster<'a>,
        solid: &'a Solid,
    ) -> Result<Self, MapError> {
        let place = |offset_m| Self::at(wanted, raster, solid, offset_m);
        if let Some(offset_m) = wanted.offset_m {
            return place(offset_m);
        }
        let mut best = place([0.0, 0.0]);
        let mut score = best.as_ref().ok().map(Self::score);
        for offset_m in shifts(wanted.cell_m, raster.map.resolution_m).skip(1) {
            let placed = place(offset_m);
            let other = placed.as_ref().ok().map(Self::score);
            if other > score {
                (best, score) = (placed, other);
            }
        }
        best
    }

    fn at(
        wanted: &Wanted,
        raster: &'a Raster<'a>,
        solid: &'a Solid,
        offset_m: [f64; 2],
    ) -> Result<Self, MapError> {
        let layout = Layout::new(raster.map, wanted.cell_m, wanted.yaw_rad, offset_m)?;
        let cells = Cells::new(raster, solid, layout, wanted.cell_m / 2.0);
        let goal = cells.cell_at("goal", wanted.goal_m)?;
        let start = wanted.start_m.map(|at| cells.cell_at("start", at));
        let start = start.transpose()?;
        let (reached, moves) = cells.reached_from(goal);
        Ok(Self {
            cells,
            start,
            goal,
            reached,
            moves,
        })
    }

    /// Returns whether the start reaches the goal, and the number of moves between cells that do.
    fn score(&self) -> (bool, usize) {
        let is_reached = self
            .start
            .is_none_or(|start| start != self.goal && self.reached[start]);
        (is_reached, self.moves)
    }
}

/// Returns all shifts to the left and downward by less than a cell, in whole pixels. Larger cells
/// have more shifts, but each shift has fewer cells, so the time depends only on the size of the
/// map.
fn shifts(cell_m: f64, pixel_m: f64) -> impl Iterator<Item = [f64; 2]> {
    let count = (cell_m / pixel_m - 1e-6).ceil() as u32;
    let along = move || (0..count).map(move |number| -f64::from(number) * pixel_m);
    along().flat_map(move |down| along().map(move |left| [left, down]))
}
