//! From the pixels of a map to a maze.

use super::cells::Cells;
use super::passage::Passage;
use super::passages::Passages;
use super::{MapError, OccupancyMap};
use crate::world::{Cell, Maze};

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
    /// Free cells from which no goal can be reached, which became walls.
    pub cut_off: usize,
    /// Passages to such cells that are there in the map, but in which no cell fits.
    pub passages: Vec<Passage>,
}

impl Gridding {
    /// Makes the maze. A cell is free if all of its pixels are.
    ///
    /// # Errors
    /// When the size of a cell does not fit, start or goal lie in a wall, or no goal can be reached
    /// from the start; then the passages are named in which no cell fits.
    pub fn of(&self, map: &OccupancyMap) -> Result<Gridded, MapError> {
        let cells = Cells::new(map, self.cell_m, self.unknown_is_free)?;
        let as_written =
            self.start_m.is_none() && self.goal_m.is_none() && cells.is_pixel_by_pixel();
        match &map.kept {
            Some((kept, greys)) if as_written => Ok(Gridded {
                maze: kept.restored(map, greys)?,
                corner_px: [0.0, 0.0],
                cut_off: 0,
                passages: Vec::new(),
            }),
            _ => self.placed(cells),
        }
    }

    /// With start and goal as they were asked for.
    fn placed(&self, mut cells: Cells<'_>) -> Result<Gridded, MapError> {
        let goal_m = self.goal_m.ok_or(MapError::NoGoal)?;
        let goal = cells.cell_at("goal", goal_m)?;
        let start = self
            .start_m
            .map(|at| cells.cell_at("start", at))
            .transpose()?;
        if start == Some(goal) {
            return Err(MapError::Point {
                what: "start",
                at_m: self.start_m.unwrap_or(goal_m),
                fault: "in the cell of the goal: move one of them, or give a smaller `--cell`"
                    .to_owned(),
            });
        }
        let reached = cells.reached_from(goal);
        let missed = start.is_some_and(|start| !reached[start])
            || reached.iter().filter(|&&r| r).count() < 2;
        let lost = (0..cells.free.len())
            .filter(|&at| cells.free[at] && !reached[at])
            .count();
        let passages = (lost > 0).then(|| Passages::find(&cells));
        if missed {
            let between = passages.map(|passages| passages.between(start, goal));
            return Err(MapError::CutOff(between.unwrap_or_default()));
        }
        let (cut_off, passages) = match (start, passages) {
            (None, Some(passages)) => (lost, passages.from(goal)),
            _ => (0, Vec::new()),
        };
        if start.is_none() {
            cells.free = reached;
        }
        let window = cells.window();
        let maze = cells.maze(&self.name, start, goal, window)?;
        let corner_px = cells.corner_px(window);
        Ok(Gridded {
            maze,
            corner_px,
            cut_off,
            passages,
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
