//! From what is true to what sensors tell. Here the true pose ends.

mod bumper;
mod encoders;
mod gyro;
mod lidar;
mod params;
mod ray;

use nalgebra::{Isometry2, Vector2};
use serde::{Deserialize, Serialize};

use self::encoders::Encoders;
use self::gyro::Gyro;
use self::lidar::Lidar;
pub use self::params::{BumperParams, EncoderParams, GyroParams, LidarParams};
use super::contact::Push;
use super::params::PhysicsParams;
use super::readings::{Readings, Return};
use crate::world::Maze;
use xcs::random::Stream;

/// What truly happens to the robot during one physics step.
pub(super) struct Moment<'a> {
    /// The number of the step since the trial began.
    pub step: u64,
    /// The pose before it, in cells.
    pub before: Isometry2<f64>,
    /// The pose after it.
    pub after: Isometry2<f64>,
    /// How far each wheel has rolled since the reset, in cells.
    pub travel: [f64; 2],
    /// The pushes of walls.
    pub pushes: &'a [Push],
}

/// All sensors of the robot.
#[derive(Debug, Clone)]
pub(super) struct Sensors {
    lidar: Lidar,
    encoders: Encoders,
    gyro: Gyro,
    bump_impulse: f64,
}

/// Everything in the sensors that changes while they run. What differs from robot to robot, such
/// as the scale of a wheel, is drawn from the seed again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SensorState {
    lidar: Stream,
    gyro: Stream,
    ticks: [i64; 2],
}

impl Sensors {
    /// The sensors of the robot that belongs to `seed`.
    pub(super) fn new(params: &PhysicsParams, seed: u64) -> Self {
        let level = params.noise;
        Self {
            lidar: Lidar::new(&params.lidar, level, seed),
            encoders: Encoders::new(&params.encoders, level, seed),
            gyro: Gyro::new(&params.gyro, level, seed),
            bump_impulse: params.bumper.impulse_ns,
        }
    }

    /// The robot was lifted and put down at rest.
    pub(super) fn reset(&mut self) {
        self.encoders.reset();
    }

    /// What the sensors tell about a step; `beams` is filled with the beams of the lidar.
    pub(super) fn read<'a>(
        &mut self,
        maze: &Maze,
        moment: &Moment<'_>,
        beams: &'a mut Vec<Return>,
    ) -> Readings<'a> {
        let turned_rad = turned(&moment.before, &moment.after);
        self.lidar.scan(maze, moment, turned_rad, beams);
        let at = moment.after.translation.vector * maze.cell_size_m();
        Readings {
            rolled: self.encoders.read(moment.travel),
            turned_rad: self.gyro.read(turned_rad),
            bumped: bumper::read(moment.after.rotation, moment.pushes, self.bump_impulse),
            over_marker: maze
                .cell_at(at.into())
                .is_some_and(|cell| maze.is_goal(cell)),
            beams,
        }
    }

    /// A copy of the state.
    pub(super) fn state(&self) -> SensorState {
        SensorState {
            lidar: self.lidar.stream.clone(),
            gyro: self.gyro.stream.clone(),
            ticks: self.encoders.ticks,
        }
    }

    /// Puts a state back.
    pub(super) fn set_state(&mut self, state: &SensorState) {
        self.lidar.stream = state.lidar.clone();
        self.gyro.stream = state.gyro.clone();
        self.encoders.ticks = state.ticks;
    }
}

/// By how much the heading changed from one pose to another, in radians; at most half a turn.
fn turned(before: &Isometry2<f64>, after: &Isometry2<f64>) -> f64 {
    let turn = (before.rotation.inverse() * after.rotation).into_inner();
    libm::atan2(turn.im, turn.re)
}

/// A unit vector along the heading of a rotation.
fn ahead(rotation: nalgebra::UnitComplex<f64>) -> Vector2<f64> {
    rotation * Vector2::x()
}
