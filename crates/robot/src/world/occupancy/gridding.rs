//! Converts the pixels of a map to a maze.

use super::cells::{Layout, ROUNDING};
use super::passage::Passage;
use super::passages::Passages;
use super::placing::{Placed, Wanted};
use super::raster::Raster;
use super::{MapError, OccupancyMap};
use crate::world::{Cell, Maze};

/// The options for converting a map to a maze.
#[derive(Debug, Clone)]
pub struct Gridding {
    /// The edge of a cell, in metres; `None` for one pixel per cell.
    pub cell_m: Option<f64>,
    /// The start in the map frame, in metres; `None` for random starts.
    pub start_m: Option<[f64; 2]>,
    /// The goal in the map frame, in metres; `None` for the goals of a maze that was written as a
    /// map.
    pub goal_m: Option<[f64; 2]>,
    /// Treat unknown pixels as free.
    pub unknown_is_free: bool,
    /// The tolerated share of occupied (or unknown) pixels in a free cell, from 0 to below 1.
    /// Above 0, the robot may touch something between free cells.
    pub occupied_fraction: f64,
    /// The largest group of connected pixels that are not free and are erased as noise; 0 keeps
    /// every pixel.
    pub despeckle: usize,
    /// The lower left corner of the grid, in metres to the right and upward from the lower left
    /// corner of the image. `None` for the offset with the most passages between cells that reach
    /// the goal.
    pub offset_m: Option<[f64; 2]>,
    /// The name of the world, unless the map file contains one.
    pub name: String,
}

/// The result of a conversion: the maze, and the parts that were left out.
#[derive(Debug)]
pub struct Gridded {
    /// The maze.
    pub maze: Maze,
    /// The upper left corner of the maze, in pixels from the upper left corner of the image.
    pub corner_px: [f64; 2],
    /// The offset of the grid relative to the image, in metres to the right and upward.
    pub offset_m: [f64; 2],
    /// The number of free cells that became walls because they cannot reach the goal.
    pub cut_off: usize,
    /// Passages to such cells that exist in the map, but are too narrow for a cell.
    pub passages: Vec<Passage>,
}

impl Gridding {
    /// Builds the maze. A cell is free if all of its pixels are, or nearly all.
    ///
    /// # Errors
    /// When the cell size is not allowed, start or goal are in a wall, or the goal cannot be
    /// reached from the start. The last error lists the passages that are too narrow for a cell.
    pub fn of(&self, map: &OccupancyMap) -> Result<Gridded, MapError> {
        let share = self.occupied_fraction;
        if !(0.0..1.0).contains(&share) {
            return Err(MapError::Cell(format!(
                "`--occupied-fraction` is {share}, but must be from 0 to below 1"
            )));
        }
        let as_written = self.start_m.is_none() && self.goal_m.is_none();
        match &map.world {
            Some(world) if as_written && self.cell_px(map) == 1.0 => Ok(Gridded {
                maze: map.restored(world)?,
                corner_px: [0.0, 0.0],
                offset_m: [0.0, 0.0],
                cut_off: 0,
                passages: Vec::new(),
            }),
            _ => self.placed(map),
        }
    }

    /// Returns the edge of a cell in pixels.
    fn cell_px(&self, map: &OccupancyMap) -> f64 {
        self.cell_m.unwrap_or(map.resolution_m) / map.resolution_m
    }

    /// Builds the maze with the requested start and goal.
    fn placed(&self, map: &OccupancyMap) -> Result<Gridded, MapError> {
        let goal_m = self.goal_m.ok_or(MapError::NoGoal)?;
        // Refuse a wrong cell size before reading any pixel.
        Layout::new(map, self.cell_m, [0.0, 0.0])?;
        let raster = Raster::new(map, self.unknown_is_free, self.despeckle);
        let share = self.occupied_fraction;
        let wanted = Wanted {
            cell_m: self.cell_m,
            cell_px: self.cell_px(map),
            start_m: self.start_m,
            goal_m,
            offset_m: self.offset_m,
            tolerated: &|pixels| (pixels as f64 * share + ROUNDING).floor() as usize,
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
    /// Returns the upper left corner of a cell in the image, in pixels.
    pub fn cell_corner_px(&self, map: &OccupancyMap, cell: Cell) -> [f64; 2] {
        let cell_px = self.maze.cell_size_m() / map.resolution_m;
        let [left, top] = self.corner_px;
        [
            left + f64::from(cell.col) * cell_px,
            top + f64::from(cell.row) * cell_px,
        ]
    }
}
