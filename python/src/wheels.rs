//! A robot whose wheels are driven from Python.

use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;
use xcscr_learner::trial::Plan;
use xcscr_robot::arena::{Robot, WheelDrive};
use xcscr_robot::world::Maze;

use crate::plan::{Choice, invalid};
use crate::robot::free_cell;

/// A differential-drive robot with direct control of the wheels, 20 times a second.
#[pyclass(frozen, module = "xcscr._native")]
pub struct Wheels {
    maze: Maze,
    /// Held only by a thread that holds Python's lock.
    drive: Mutex<WheelDrive>,
}

impl Wheels {
    fn drive(&self) -> MutexGuard<'_, WheelDrive> {
        self.drive.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Wheels {
    #[new]
    fn new(py: Python<'_>, choice: Choice) -> PyResult<Self> {
        py.detach(|| {
            let Plan { maze, config } = choice.plan(None, 1)?;
            let robot = Robot::new(maze.clone(), config.settings.physics, config.seed);
            let drive = WheelDrive::new(robot.map_err(invalid)?);
            Ok(Self {
                drive: Mutex::new(drive),
                maze,
            })
        })
    }

    /// Restarts the random numbers of the wheel noise from a seed.
    fn reseed(&self, seed: u64) {
        self.drive().reseed(seed);
    }

    /// Places the robot at rest in the middle of a free cell, with a heading in radians.
    fn reset(&self, start: (u16, u16), heading: f64) -> PyResult<()> {
        let cell = free_cell(&self.maze, start)?;
        self.drive().reset(cell, heading);
        Ok(())
    }

    /// Drives for 50 ms at the commanded rim speeds of the left and right wheel, in m/s. Returns
    /// whether the robot is in a goal cell, and the total impulse of wall collisions in
    /// newton-seconds.
    fn step(&self, left: f64, right: f64) -> (bool, f64) {
        let mut drive = self.drive();
        drive.step([left, right]);
        (drive.has_arrived(), drive.impulse_n_s())
    }

    /// Returns the distances to the nearest wall in metres, at most `limit`, counter-clockwise from
    /// straight ahead.
    fn ranges(&self, beams: usize, limit: f64) -> Vec<f64> {
        self.drive().ranges_m(beams, limit)
    }

    /// Returns the distance to the nearest goal in metres, and its bearing in radians from straight
    /// ahead.
    #[getter]
    fn goal(&self) -> (f64, f64) {
        self.drive().goal()
    }

    /// Returns the pose in the map frame: x and y in metres, heading in radians from the x axis.
    #[getter]
    fn pose(&self) -> (f64, f64, f64) {
        let pose = self.drive().view().now().robot_in_map;
        (
            pose.translation.x,
            pose.translation.y,
            pose.rotation.angle(),
        )
    }

    /// Returns the maximum rim speed in m/s.
    #[getter]
    fn max_speed(&self) -> f64 {
        self.drive().max_speed_mps()
    }
}
