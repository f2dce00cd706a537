//! Measures whether a robot senses a world as it is.

use nalgebra::Vector2;
use xcscr_sensing::cast;

use super::{Localisation, PhysicsArena, PhysicsError, PhysicsParams};
use crate::arena::{Arena, Sensed};
use crate::sensor::Sensor;
use crate::world::{Cell, Maze};

/// The largest number of cells in which the robot is put down.
const MOST_PLACES: usize = 500;

/// Returns the distance in metres from a wall at a range of `wall_m` above which a beam is off: a
/// share of a cell plus a share of the range.
pub fn beam_tolerance_m(maze: &Maze, wall_m: f64) -> f64 {
    0.2 * maze.cell_size_m() + 0.05 * wall_m
}

/// What a robot without noise senses where it is put down, compared with the world.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Agreement {
    /// The number of cells in which the robot was put down.
    pub places: u32,
    /// The number of wrong percepts.
    pub wrong_percepts: u32,
    /// The number of beams that came back.
    pub beams: u32,
    /// The number of beams that do not end at a wall, seen from the estimated pose.
    pub beams_off: u32,
}

impl Agreement {
    /// Puts a robot into the middles of free cells, at most 500, and lets it look round.
    ///
    /// # Errors
    /// Those of [`PhysicsArena::new`].
    pub fn measure(
        maze: &Maze,
        params: &PhysicsParams,
        sensor: Sensor,
    ) -> Result<Self, PhysicsError> {
        let params = PhysicsParams {
            noise: 0.0,
            localisation: Localisation::Estimated,
            ..params.clone()
        };
        let range_m = params.lidar.range_m;
        let fitted = maze.for_robot(params.needed_m());
        let maze = fitted.as_ref().unwrap_or(maze);
        let mut arena = PhysicsArena::new(maze.clone(), params, 1)?;
        let cells: Vec<Cell> = maze
            .free_cells()
            .filter(|&cell| !maze.is_goal(cell))
            .collect();
        let mut found = Self::default();
        for &cell in cells
            .iter()
            .step_by(cells.len().div_ceil(MOST_PLACES).max(1))
        {
            arena.reset(cell);
            let view = arena.view();
            let is_wrong = sensor.perceive(&view) != sensor.perceive_at(maze, cell);
            found.places += 1;
            found.wrong_percepts += u32::from(is_wrong);
            if let Some(sensed) = view.sensed {
                found.add_beams(maze, &sensed, range_m);
            }
        }
        Ok(found)
    }

    /// Compares the beams of a robot at rest with the walls.
    fn add_beams(&mut self, maze: &Maze, sensed: &Sensed<'_>, range_max_m: f64) {
        let Some(estimate) = sensed.estimates.last() else {
            return;
        };
        let in_map = estimate.robot_in_map;
        let pose = maze
            .grid_in_map()
            .map_or(in_map, |grid| grid.inverse() * in_map);
        for beam in sensed.beams {
            let Some(range_m) = beam.range_m.filter(|&range_m| range_m > 0.0) else {
                continue;
            };
            let direction = (pose.rotation * beam.bearing) * Vector2::x();
            let origin = pose.translation.vector;
            let wall_m = cast(maze, origin, direction, range_max_m).unwrap_or(range_max_m);
            self.beams += 1;
            self.beams_off += u32::from((range_m - wall_m).abs() > beam_tolerance_m(maze, wall_m));
        }
    }
}
