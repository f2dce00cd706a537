//! The best possible mean steps in a world: with a known cell, and with a known world but an unknown start.

mod belief;

use serde::Serialize;

use belief::KnownWorld;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, Maze, Paths};

/// The maximum number of cells of a world for the unknown-start optimum.
const MOST_CELLS: usize = 1 << 16;
/// The cost if no path leads to a goal.
const NEVER: f64 = 65_535.0;

/// Minimum mean steps to a goal over all starts, with exact moves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bounds {
    /// The percept.
    pub sensor: Sensor,
    /// The full-state optimum: the cell is always known.
    pub full: f64,
    /// The unknown-start optimum: the world and the history since the start are known, but not the start. `None` if
    /// there are too many sets of cells.
    pub unknown_start: Option<f64>,
}

impl Bounds {
    /// Computes the bounds of a world for a robot with `sensor`. They are exact.
    pub fn new(maze: &Maze, sensor: Sensor) -> Self {
        let paths = Paths::new(maze);
        let steps = maze.starts().map(|cell| steps_from(&paths, maze, cell));
        Self {
            sensor,
            full: steps.sum::<f64>() / maze.starts().count() as f64,
            unknown_start: Self::unknown_start(maze, sensor),
        }
    }

    /// Returns only the unknown-start optimum. It is computed once for a maze and its clones.
    pub fn unknown_start(maze: &Maze, sensor: Sensor) -> Option<f64> {
        let paths = Paths::new(maze);
        if let Some(start) = maze.start() {
            // With a known start and exact moves, the cell is always known.
            return Some(steps_from(&paths, maze, start));
        }
        maze.once(sensor.name(), || {
            let cells: Vec<Cell> = maze
                .free_cells()
                .filter(|&cell| !maze.is_goal(cell))
                .collect();
            let steps = cells.iter().map(|&cell| steps_from(&paths, maze, cell));
            (cells.len() <= MOST_CELLS)
                .then(|| KnownWorld::new(maze, sensor, &cells, steps.collect()).steps())
                .flatten()
        })
    }
}

fn steps_from(paths: &Paths, maze: &Maze, cell: Cell) -> f64 {
    paths.expected_steps(maze, cell).unwrap_or(NEVER)
}
