//! The robot's own computer: all that it knows comes from its sensors.
//!
//! Nothing in this folder may name the maze, the engine or a true pose; `tests/layering.rs`
//! watches over it. The robot is told where it is put down, which directions its actions mean and
//! how large a cell is, and gets [`Readings`] from then on.

mod controller;
mod estimator;
mod mapper;
mod params;
#[cfg(test)]
mod tests;

use nalgebra::{Isometry2, Matrix3, Point2};

pub(super) use self::controller::Maneuver;
pub(super) use self::estimator::Belief;
use self::estimator::Estimator;
use self::mapper::cell_of;
pub use self::params::EstimatorParams;
use super::motion::Motion;
use super::params::PhysicsParams;
use super::readings::Readings;
use crate::arena::Surroundings;

/// What the robot knows.
#[derive(Debug, Clone)]
pub(super) struct Onboard {
    estimator: Estimator,
    surroundings: Surroundings,
    bumped: [bool; 2],
    over_marker: bool,
}

impl Onboard {
    /// A robot that knows nothing of its sensors yet.
    pub(super) fn new(params: &PhysicsParams) -> Self {
        Self {
            estimator: Estimator::new(params),
            surroundings: Surroundings::unknown([0; 2]),
            bumped: [false; 2],
            over_marker: false,
        }
    }

    /// The robot is put down at rest.
    pub(super) fn put_down(&mut self, pose: Isometry2<f64>) {
        self.estimator.put_down(pose);
        self.begin_action();
    }

    /// A new action begins: what was seen before is forgotten, for a wrong sight must not last.
    pub(super) fn begin_action(&mut self) {
        self.surroundings.forget(self.cell());
    }

    /// Takes in what the sensors tell about a step.
    pub(super) fn step(&mut self, readings: &Readings<'_>) {
        self.estimator.step(readings);
        for beam in readings.beams {
            mapper::mark(&mut self.surroundings, &self.estimator.ray(beam));
        }
        self.surroundings.stand_in(self.cell());
        self.bumped = readings.bumped;
        self.over_marker = readings.over_marker;
    }

    /// Where it believes to be and how it believes to move.
    pub(super) fn motion(&self) -> Motion {
        let (forward, turn_radps) = self.estimator.speeds();
        Motion {
            pose: self.estimator.pose(),
            forward,
            sideways: 0.0,
            turn_radps,
        }
    }

    /// The pose that it believes in, with its covariance.
    pub(super) fn estimate(&self) -> (Isometry2<f64>, Matrix3<f64>) {
        (self.estimator.pose(), self.estimator.covariance())
    }

    /// The cell that it believes to stand in, counted to the east and to the north.
    pub(super) fn cell(&self) -> [i32; 2] {
        cell_of(self.estimator.pose().translation.vector)
    }

    /// The middle of that cell.
    pub(super) fn middle(&self) -> Point2<f64> {
        let [east, north] = self.cell().map(f64::from);
        Point2::new(east + 0.5, north + 0.5)
    }

    /// Did the bumper close that leads on the way of a manoeuvre?
    pub(super) fn is_bumped(&self, maneuver: &Maneuver) -> bool {
        let [front, rear] = self.bumped;
        if maneuver.front_leads() { front } else { rear }
    }

    /// Does it see the marker of a goal below itself?
    pub(super) fn over_marker(&self) -> bool {
        self.over_marker
    }

    /// What it made out around itself in this action.
    pub(super) fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// The state of its filter.
    pub(super) fn belief(&self) -> &Belief {
        self.estimator.belief()
    }

    /// Puts a state of the filter back, and what it had made out.
    pub(super) fn restore(&mut self, belief: Belief, surroundings: Surroundings) {
        self.estimator.set_belief(belief);
        self.surroundings = surroundings;
    }
}
