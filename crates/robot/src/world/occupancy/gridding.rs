//! Converts the pixels of a map to a maze.

use super::cells::Layout;
use super::placing::{Placed, Wanted};
use super::raster::Raster;
use super::{MapError, OccupancyMap};
use crate::world::{Maze, Narrowest};

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
    /// The largest group of connected pixels that are not free and are erased as noise; 0 keeps
    /// every pixel.
    pub despeckle: usize,
    /// The angle in radians from the lower edge of the image to the rows of the grid,
    /// counter-clockwise, from -90 to 90 degrees.
    pub yaw_rad: f64,
    /// The lower left corner of the grid, in metres to the right and upward along the grid from the
    /// smallest grid that covers the image. `None` for the offset with the most moves between cells
    /// that reach the goal.
    pub offset_m: Option<[f64; 2]>,
    /// The name of the world, unless the map file contains one.
    pub name: String,
}

/// The result of a conversion: the maze, and the parts that were left out.
#[derive(Debug)]
pub struct Gridded {
    /// The maze.
    pub maze: Maze,
    /// The offset of the grid relative to the image, in metres to the right and upward.
    pub offset_m: [f64; 2],
    /// The number of free cells that became walls because they cannot reach the goal.
    pub cut_off: usize,
    /// The number of occupied or unknown pixels that were erased as noise.
    pub erased: usize,
}

impl Gridding {
    /// Builds the maze. A cell is free if a disc in it, as wide as the cell, touches nothing. A move
    /// is open if this disc stays clear on its way.
    ///
    /// # Errors
    /// When the cell size is not allowed, start or goal are in a wall, or the goal cannot be
    /// reached from the start. The last error has the narrowest place of the widest way.
    pub fn of(&self, map: &OccupancyMap) -> Result<Gridded, MapError> {
        let as_written = self.start_m.is_none() && self.goal_m.is_none();
        match &map.world {
            Some(world) if as_written && self.cell_m(map) == map.resolution_m => Ok(Gridded {
                maze: map.restored(world)?,
                offset_m: [0.0, 0.0],
                cut_off: 0,
                erased: 0,
            }),
            _ => self.placed(map),
        }
    }

    fn cell_m(&self, map: &OccupancyMap) -> f64 {
        self.cell_m.unwrap_or(map.resolution_m)
    }

    /// Builds the maze with the requested start and goal.
    fn placed(&self, map: &OccupancyMap) -> Result<Gridded, MapError> {
        let goal_m = self.goal_m.ok_or(MapError::NoGoal)?;
        let wanted = Wanted {
            cell_m: self.cell_m(map),
            yaw_rad: self.yaw_rad,
            start_m: self.start_m,
            goal_m,
            offset_m: self.offset_m,
        };
        // Refuse a wrong cell size before reading any pixel.
        Layout::new(map, wanted.cell_m, self.yaw_rad, [0.0, 0.0])?;
        let raster = Raster::new(map, self.unknown_is_free, self.despeckle);
        let solid = raster.in_image();
        let placed = Placed::find(&wanted, &raster, &solid)?;
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
        if missed {
            let ends = start.map(|start| [start, goal].map(|at| cells.layout.middle(at)));
            let narrowest = ends.map(|ends| {
                let found = solid.narrowest_between(ends);
                found.map(|found| Narrowest {
                    at: map.origin.to_map(found.at),
                    ..found
                })
            });
            return Err(MapError::CutOff(narrowest));
        }
        let free = cells.free.iter().zip(&reached);
        let cut_off = free.filter(|&(&free, &reached)| free && !reached).count();
        cells.free = reached;
        let window = cells.window(goal);
        Ok(Gridded {
            maze: cells.maze(&self.name, start, goal, window)?,
            offset_m: cells.layout.offset_m,
            cut_off,
            erased: raster.erased,
        })
    }
}
