//! What observers see of a robot that localises itself: its estimates and its beams.

use nalgebra::Isometry2;

use super::pilot::{Pilot, local_map};
use super::robot::Robot;
use crate::arena::{Beam, Estimate, Sensed};
use crate::world::{Cell, Maze};
use xcscr_sensing::{Onboard, STEP_NS};

/// The estimates and the beams since the last reset or action began.
#[derive(Default)]
pub(super) struct Records {
    estimates: Vec<Estimate>,
    beams: Vec<Beam>,
}

impl Records {
    /// Starts again with the current estimate.
    pub(super) fn begin(&mut self, pilot: &Pilot, maze: &Maze) {
        self.estimates.clear();
        self.beams.clear();
        self.estimates.push(estimate_in_map(pilot, maze));
    }

    /// Adds the current estimate, and the beams of the last step. Adds nothing for a robot that is told its pose.
    pub(super) fn add(&mut self, pilot: &Pilot, robot: &Robot) {
        if pilot.onboard().is_none() {
            return;
        }
        self.estimates.push(estimate_in_map(pilot, robot.maze()));
        let start_ns = robot.time_ns() - STEP_NS;
        let beams = robot.returns().iter().map(|beam| Beam {
            time_ns: start_ns + (beam.moment * STEP_NS as f64) as u64,
            bearing: beam.bearing,
            range_m: beam.range_m,
        });
        self.beams.extend(beams);
    }

    /// Returns the sensor data for observers and percepts; `None` for a robot that is told its pose.
    pub(super) fn sensed<'a>(&'a self, pilot: &'a Pilot, robot: &Robot) -> Option<Sensed<'a>> {
        let (onboard, maze) = (pilot.onboard()?, robot.maze());
        let cell_of = |pose: Isometry2<f64>| maze.cell_in_grid(pose.translation.vector.into());
        Some(Sensed {
            local_map: local_map(onboard, cell_within(maze, onboard)),
            estimates: &self.estimates,
            beams: &self.beams,
            mislocalised: cell_of(robot.pose()) != cell_of(onboard.estimate().0),
        })
    }
}

/// Returns the estimate of a pilot in the map frame.
fn estimate_in_map(pilot: &Pilot, maze: &Maze) -> Estimate {
    let (robot_in_grid, covariance) = pilot.estimate();
    Estimate {
        robot_in_map: maze.pose_in_map(robot_in_grid),
        covariance: maze.covariance_in_map(covariance),
    }
}

/// Returns the estimated cell, or the nearest one of the grid. It may be a wall.
fn cell_within(maze: &Maze, onboard: &Onboard) -> Cell {
    let [east, north] = onboard.cell();
    let (width, height) = (i32::from(maze.width()), i32::from(maze.height()));
    Cell {
        // Both are below the maze's size, which is a u16.
        col: east.clamp(0, width - 1) as u16,
        row: (height - 1).saturating_sub(north).clamp(0, height - 1) as u16,
    }
}
