//! From the pixels of a map to a maze.

use super::cells::{Layout, ROUNDING};
use super::passage::Passage;
use super::passages::Passages;
use super::placing::{Placed, Wanted};
use super::raster::Raster;
use super::{MapError, OccupancyMap};
use crate::world::{Cell, Maze};

/// The share of the pixels of a free cell that may be occupied: two of the hundred of a cell of 0.5 m
/// at 5 cm, so that noise beside a wall does not close a cell, and a chair leg in it does.
const OCCUPIED_FRACTION: f64 = 0.02;

/// How a map becomes a maze.
#[derive(Debug, Clone)]
pub struct Gridding {
    /// Edge of a cell, in metres; `None` for one pixel per cell.
    pub cell_m: Option<f64>,
    /// Where episodes start, in the map's frame, in metres; anywhere if `None`.
    pub start_m: Option<[f64; 2]>,
    /// The goal, in the map's frame, in metres; `None` for the goals of a maze that was written as
    /// a map.
    pub goal_m: Option<[f64; 2]>,
    /// May the robot go where nobody looked?
    pub unknown_is_free: bool,
    /// The share of the pixels of a cell, from 0 to below 1, that may be occupied (or unknown) in a
    /// free cell. `None` for 0.02, but always less than half of a line of pixels across the cell,
    /// so that the thinnest wall is one.
    pub occupied_fraction: Option<f64>,
    /// Groups of so many connected pixels that are not free are taken for noise. `None` for as many
    /// as may be occupied in a free cell.
    pub despeckle: Option<usize>,
    /// The lower left corner of the grid, in metres to the right and upward from that of the image;
    /// `None` for where most passages between cells lead to the goal.
    pub offset_m: Option<[f64; 2]>,
    /// The name of the world, unless the map keeps one.
    pub name: String,
}

/// A maze made of a map, and what became of the rest.
#[derive(Debug)]
pub struct Gridded {
    /// The maze.
    pub maze: Maze,
    /// Where the upper left corner of the maze lies in the image, in pixels from its upper left
    /// corner.
    pub corner_px: [f64; 2],
    /// How far the grid was shifted against the image, in metres to the right and upward.
    pub offset_m: [f64; 2],
    /// Free cells from which no goal can be reached, which became walls.
    pub cut_off: usize,
    /// Passages to such cells that are there in the map, but in which no cell fits.
    pub passages: Vec<Passage>,
}

impl Gridding {
    /// Makes the maze. A cell is free if nearly all of its pixels are.
    ///
    /// # Errors
    /// When the size of a cell does not fit, start or goal lie in a wall, or no goal can be reached
    /// from the start; then the passages are named in which no cell fits.
    pub fn of(&self, map: &OccupancyMap) -> Result<Gridded, MapError> {
        let share = self.occupied_fraction.unwrap_or(0.0);
        if !(0.0..1.0).contains(&share) {
            return Err(MapError::Cell(format!(
                "`--occupied-fraction` is {share}, but must be from 0 to below 1"
            )));
        }
        let as_written = self.start_m.is_none() && self.goal_m.is_none();
        match &map.kept {
            Some((kept, greys)) if as_written && self.cell_px(map) == 1.0 => Ok(Gridded {
                maze: kept.restored(map, greys)?,
                corner_px: [0.0, 0.0],
                offset_m: [0.0, 0.0],
                cut_off: 0,
                passages: Vec::new(),
            }),
            _ => self.placed(map),
        }
    }

    /// Pixels along a cell.
    fn cell_px(&self, map: &OccupancyMap) -> f64 {
        self.cell_m.unwrap_or(map.resolution_m) / map.resolution_m
    }

    /// How many of so many pixels of a cell may be occupied in a free one.
    fn tolerated(&self, map: &OccupancyMap, pixels: usize) -> usize {
        let share = |fraction: f64| (pixels as f64 * fraction + ROUNDING).floor();
        let half_a_line = || ((self.cell_px(map) - 1.0) / 2.0).floor();
        let least = || share(OCCUPIED_FRACTION).min(half_a_line());
        self.occupied_fraction.map_or_else(least, share) as usize
    }

    /// With start and goal as they were asked for.
    fn placed(&self, map: &OccupancyMap) -> Result<Gridded, MapError> {
        let goal_m = self.goal_m.ok_or(MapError::NoGoal)?;
        // What does not fit is refused before any pixel is looked at.
        Layout::new(map, self.cell_m, [0.0, 0.0])?;
        let in_a_cell = self.cell_px(map).powi(2).round() as usize;
        let speck = self.despeckle.unwrap_or(self.tolerated(map, in_a_cell));
        let raster = Raster::new(map, self.unknown_is_free, speck);
        let wanted = Wanted {
            cell_m: self.cell_m,
            cell_px: self.cell_px(map),
            start_m: self.start_m,
            goal_m,
            offset_m: self.offset_m,
            tolerated: &|pixels| self.tolerated(map, pixels),
        };
        let placed = Placed::find(&wanted, &raster)?;
        let (mut cells, start, goal) = (placed.cells, placed.start, placed.goal);
        if start == Some(goal) {
            return Err(MapError::Point {
                what: "start",
                at_m: self.start_m.unwrap_or(goal_m),
                fault: "in the cell of the goal: move one of them, or give a smaller `--cell`"
                    .to_owned(),
            });
        }
        let reached = placed.reached;
        let missed = start.is_some_and(|start| !reached[start])
            || reached.iter().filter(|&&r| r).count() < 2;
        let free = cells.free.iter().zip(&reached);
        let cut_off = free.filter(|&(&free, &reached)| free && !reached).count();
        let passages = (cut_off > 0).then(|| Passages::find(&cells));
        if missed {
            let between = passages.map(|passages| passages.between(start, goal));
            return Err(MapError::CutOff(between.unwrap_or_default()));
        }
        cells.free = reached;
        let window = cells.window();
        Ok(Gridded {
            maze: cells.maze(&self.name, start, goal, window)?,
            corner_px: cells.corner_px(window),
            offset_m: cells.offset_m(),
            cut_off,
            passages: passages.map_or_else(Vec::new, |passages| passages.from(goal)),
        })
    }
}

impl Gridded {
    /// The upper left corner of a cell in the image, in pixels.
    pub fn cell_corner_px(&self, map: &OccupancyMap, cell: Cell) -> [f64; 2] {
        let cell_px = self.maze.cell_size_m() / map.resolution_m;
        let [left, top] = self.corner_px;
        [
            left + f64::from(cell.col) * cell_px,
            top + f64::from(cell.row) * cell_px,
        ]
    }
}
