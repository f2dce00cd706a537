//! The robot's own computer: all that it knows comes from its sensors.
//!
//! Nothing in this folder may name the sensors, the walls or a true pose; `tests/onboard.rs` checks that. The robot is told where it is put down, and gets [`Readings`] from
//! then on.

mod angle;
mod assumed;
mod estimator;
mod mapper;
mod slip;
mod surroundings;
#[cfg(test)]
mod tests;

use nalgebra::{Isometry2, Matrix3, Point2};

pub use self::estimator::Belief;
use self::estimator::Estimator;
use self::mapper::cell_of;
pub use self::surroundings::Surroundings;
use crate::{Readings, Return, Robot};

/// What the robot knows.
#[derive(Debug, Clone)]
pub struct Onboard {
    estimator: Estimator,
    surroundings: Surroundings,
    every_nth_beam: u32,
    /// The beams of a step that it takes.
    taken: Vec<Return>,
    bumped: [bool; 2],
    over_marker: bool,
    cell_size_m: f64,
    /// How far beams are taken to go that hit something too near to be measured, or do not come back.
    assumed_ranges_m: [f64; 2],
}

impl Onboard {
    /// A robot that knows nothing of its sensors yet.
    pub fn new(robot: &Robot) -> Self {
        Self {
            estimator: Estimator::new(robot),
            surroundings: Surroundings::unknown([0; 2]),
            every_nth_beam: robot.estimator.use_every_nth_beam,
            taken: Vec::new(),
            bumped: [false; 2],
            over_marker: false,
            cell_size_m: robot.cell_size_m,
            assumed_ranges_m: [
                robot.lidar.nearest_m,
                robot.lidar.lost_beam_range_m(robot.cell_size_m),
            ],
        }
    }

    /// Puts the robot down at rest, at a pose of the grid frame.
    pub fn put_down(&mut self, pose: Isometry2<f64>) {
        self.estimator.put_down(pose);
        self.begin_action();
    }

    /// A new action begins: what was seen before is forgotten, for a wrong sight must not last.
    pub fn begin_action(&mut self) {
        self.surroundings.forget(self.cell());
        self.estimator.begin_action();
    }

    /// Takes in what the sensors tell about a step.
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
        for ray in self.estimator.rays(&self.taken) {
            let (size_m, ranges_m) = (self.cell_size_m, self.assumed_ranges_m);
            mapper::mark(&mut self.surroundings, &ray, size_m, ranges_m);
        }
        self.surroundings.stand_in(self.cell());
        self.bumped = readings.bumped;
        self.over_marker = readings.over_marker;
    }

    /// Estimated speed along the heading in m/s and turn rate in rad/s.
    pub fn speeds(&self) -> (f64, f64) {
        self.estimator.speeds()
    }

    /// The estimated pose in the grid frame, in metres, and the covariance of x, y and heading.
    pub fn estimate(&self) -> (Isometry2<f64>, Matrix3<f64>) {
        (self.estimator.pose(), self.estimator.covariance())
    }

    /// The estimated cell, counted to the east and to the north.
    pub fn cell(&self) -> [i32; 2] {
        cell_of(self.estimator.pose().translation.vector, self.cell_size_m)
    }

    /// The middle of the estimated cell in the grid frame, in metres.
    pub fn middle(&self) -> Point2<f64> {
        let [east, north] = self.cell().map(f64::from);
        Point2::new(
            (east + 0.5) * self.cell_size_m,
            (north + 0.5) * self.cell_size_m,
        )
    }

    /// Did the front and did the rear bumper close in the last step?
    pub fn bumped(&self) -> [bool; 2] {
        self.bumped
    }

    /// Has it noticed that its wheels slip, a moment ago or now?
    pub fn slips(&self) -> bool {
        self.estimator.slips()
    }

    /// Does it see the marker of a goal below itself?
    pub fn over_marker(&self) -> bool {
        self.over_marker
    }

    /// What it made out around itself in this action.
    pub fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// The state of its filter.
    pub fn belief(&self) -> &Belief {
        self.estimator.belief()
    }

    /// Puts a state of the filter back, and what it had made out.
    pub fn restore(&mut self, belief: Belief, surroundings: Surroundings) {
        self.estimator.set_belief(belief);
        self.surroundings = surroundings;
    }
}
