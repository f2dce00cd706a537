//! The robot's own computer, whose only inputs are sensor readings.
//!
//! Nothing in this folder may name the sensors, the walls or a true pose; `tests/onboard.rs` checks
//! that. The robot is given the pose where it is put down, and receives [`Readings`] from then on.

mod angle;
mod assumed;
mod estimator;
mod field;
mod mapper;
mod obstacles;
mod wheel_slip;
mod surroundings;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use nalgebra::{Isometry2, Matrix3, Point2, Vector2};

use self::estimator::Estimator;
pub use self::field::{Field, Surface};
use self::mapper::cell_of;
pub use self::obstacles::Obstacles;
pub use self::surroundings::Surroundings;
use crate::{Readings, Return, RobotParams};

/// The deviations of the pose where a robot is put down: in metres, and in radians.
pub const PUT_DOWN: [f64; 2] = [0.01; 2];

/// The onboard computer: pose estimate and local map.
#[derive(Debug, Clone)]
pub struct Onboard {
    estimator: Estimator,
    surroundings: Surroundings,
    obstacles: Obstacles,
    every_nth_beam: u32,
    /// The beams of a step that are used.
    taken: Vec<Return>,
    over_marker: bool,
    cell_size_m: f64,
    /// The assumed ranges of beams that hit something too near to be measured, and of beams that do
    /// not come back.
    assumed_ranges_m: [f64; 2],
}

impl Onboard {
    /// Creates an onboard computer with uncalibrated sensors and without a map.
    pub fn new(robot: &RobotParams) -> Self {
        Self {
            estimator: Estimator::new(robot),
            surroundings: Surroundings::unknown([0; 2]),
            obstacles: Obstacles::default(),
            every_nth_beam: robot.estimator.use_every_nth_beam,
            taken: Vec::new(),
            over_marker: false,
            cell_size_m: robot.cell_size_m,
            assumed_ranges_m: [
                robot.lidar.nearest_m,
                robot.lidar.lost_beam_range_m(robot.cell_size_m),
            ],
        }
    }

    /// Gives the robot a map to localise itself by.
    #[must_use]
    pub fn with_map(mut self, map: Arc<dyn Field>) -> Self {
        self.estimator.use_map(map);
        self
    }

    /// Puts the robot down at rest, at a pose of the grid frame, within about a centimetre and 0.6
    /// degrees.
    pub fn put_down(&mut self, pose: Isometry2<f64>) {
        self.put_down_within(pose, PUT_DOWN);
    }

    /// Puts the robot down at rest, at a pose of the grid frame with these deviations: in metres, and in
    /// radians.
    pub fn put_down_within(&mut self, pose: Isometry2<f64>, deviations: [f64; 2]) {
        self.estimator.put_down(pose, deviations);
        self.begin_action();
    }

    /// Begins an action. Clears the local map, so that an observation error cannot persist.
    pub fn begin_action(&mut self) {
        self.surroundings.forget(self.cell());
        self.obstacles.forget();
        self.estimator.begin_action();
    }

    /// Updates the estimates with the readings of a step.
    pub fn step(&mut self, readings: &Readings<'_>) {
        let every = self.every_nth_beam;
        let is_taken = |beam: &&Return| beam.number.is_multiple_of(every);
        self.taken.clear();
        self.taken.extend(readings.beams.iter().filter(is_taken));
        let taken = Readings {
            beams: &self.taken,
            ..*readings
        };
        self.estimator.step(&taken);
        let (size_m, ranges_m) = (self.cell_size_m, self.assumed_ranges_m);
        for ray in self.estimator.rays(&self.taken) {
            match self.estimator.has_map() {
                true => self.obstacles.see(&ray, ranges_m),
                false => mapper::mark(&mut self.surroundings, &ray, size_m, ranges_m),
            }
        }
        self.surroundings.stand_in(self.cell());
        self.over_marker = readings.over_marker;
    }

    /// Returns the estimated speed along the heading in m/s and the turn rate in rad/s.
    pub fn speeds(&self) -> (f64, f64) {
        self.estimator.speeds()
    }

    /// Returns the estimated motion in the last step: the way in metres of the grid frame, and the
    /// turn in radians. The beams of the step were sent along it.
    pub fn last_motion(&self) -> (Vector2<f64>, f64) {
        self.estimator.last_motion()
    }

    /// Returns the estimated factor by which ranges are longer than measured.
    pub fn range_scale(&self) -> f64 {
        self.estimator.range_scale()
    }

    /// Returns the estimated pose in the grid frame, in metres, and the covariance of x, y and
    /// heading.
    pub fn estimate(&self) -> (Isometry2<f64>, Matrix3<f64>) {
        (self.estimator.pose(), self.estimator.covariance())
    }

    /// Returns the estimated cell, counted to the east and to the north.
    pub fn cell(&self) -> [i32; 2] {
        cell_of(self.estimator.pose().translation.vector, self.cell_size_m)
    }

    /// Returns the middle of the estimated cell in the grid frame, in metres.
    pub fn middle(&self) -> Point2<f64> {
        let [east, north] = self.cell().map(f64::from);
        Point2::new(
            (east + 0.5) * self.cell_size_m,
            (north + 0.5) * self.cell_size_m,
        )
    }

    /// Returns true if wheel slip was detected recently.
    pub fn slips(&self) -> bool {
        self.estimator.slips()
    }

    /// Returns true if the robot is above the marker of a goal.
    pub fn over_marker(&self) -> bool {
        self.over_marker
    }

    /// Returns the beams of this action as evidence about obstacles; nothing without a map.
    pub fn obstacles(&self) -> &Obstacles {
        &self.obstacles
    }

    /// Returns the cells around the robot, as observed in this action. Empty with a map.
    pub fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }
}
