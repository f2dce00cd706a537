//! Simulated sensors: from ground truth to readings. Code after the sensors has no true pose.

mod bumper;
mod encoders;
mod faults;
mod gyro;
mod lidar;
mod ray;

use nalgebra::{Isometry2, UnitComplex, Vector2};

use self::encoders::Encoders;
use self::faults::Faults;
use self::gyro::Gyro;
use self::lidar::Lidar;
pub use self::ray::cast;
use crate::{Readings, Return, RobotParams};
use xcs::random::Stream;

/// The solid geometry that the robot drives through: a raster of pixels, counted to the right and
/// upward from its lower left corner. Beyond the border everything is solid.
pub trait Terrain {
    /// Returns the edge length of a pixel in metres.
    fn pixel_m(&self) -> f64;

    /// Returns the pose of the lower left corner in the grid frame; `None` if it is the grid frame.
    fn corner_in_grid(&self) -> Option<&Isometry2<f64>> {
        None
    }

    /// Returns true if the pixel is solid.
    fn is_solid(&self, col: i32, row: i32) -> bool;

    /// Returns a length in metres below which nothing is solid around any point of the pixel. 0
    /// means that it is unknown.
    fn clear_m(&self, _col: i32, _row: i32) -> f64 {
        0.0
    }

    /// Returns true if there is a marker on the floor at a point of the grid frame, in metres.
    fn is_marked(&self, point_m: Vector2<f64>) -> bool;
}

/// A wall pushing on the robot during one step.
#[derive(Debug, Clone, Copy)]
pub struct Push {
    /// Unit vector from the robot into the wall.
    pub normal: Vector2<f64>,
    /// Force times duration of the step, in N s.
    pub impulse_n_s: f64,
}

/// The random streams of the sensors.
#[derive(Debug, Clone)]
pub struct Streams {
    /// For the lidar: its scale, and the noise of its beams.
    pub lidar: Stream,
    /// For the encoders: the scales of the wheels.
    pub encoders: Stream,
    /// For the gyro: bias, scale and noise.
    pub gyro: Stream,
}

/// The ground truth of one step.
pub struct Moment<'a> {
    /// The number of the step since the trial began.
    pub step: u64,
    /// The pose before the step, in metres of the grid frame.
    pub before: Isometry2<f64>,
    /// The pose after the step.
    pub after: Isometry2<f64>,
    /// The distance that each wheel has rolled since the reset, in metres.
    pub travel_m: [f64; 2],
    /// The pushes of walls.
    pub pushes: &'a [Push],
}

/// All sensors of the robot.
#[derive(Debug, Clone)]
pub struct Sensors {
    lidar: Lidar,
    encoders: Encoders,
    gyro: Gyro,
    bump_impulse: f64,
    faults: Faults,
}

impl Sensors {
    /// Creates the sensors of a robot. Properties that differ between robots are drawn from
    /// `streams`.
    pub fn new(robot: &RobotParams, streams: Streams) -> Self {
        let level = robot.noise;
        Self {
            lidar: Lidar::new(&robot.lidar, level, streams.lidar),
            encoders: Encoders::new(&robot.encoders, level, streams.encoders),
            gyro: Gyro::new(&robot.gyro, level, streams.gyro),
            bump_impulse: robot.bumper.impulse_ns,
            faults: Faults::new(&robot.faults),
        }
    }

    /// Counts from here: the robot was lifted and put down at rest in an episode, counted from 1. Number 0 comes before
    /// the first episode.
    pub fn reset(&mut self, episode: u32) {
        self.encoders.reset();
        self.faults.begin_episode(episode);
    }

    /// Returns the readings of a step; fills `beams` with the beams of the lidar.
    pub fn read<'a>(
        &mut self,
        terrain: &impl Terrain,
        moment: &Moment<'_>,
        beams: &'a mut Vec<Return>,
    ) -> Readings<'a> {
        let turned_rad = turned(&moment.before, &moment.after);
        self.lidar.scan(terrain, moment, turned_rad, beams);
        self.faults.blind(beams);
        let mut readings = Readings {
            rolled_m: self.encoders.read(moment.travel_m),
            turned_rad: self.gyro.read(turned_rad),
            told: None,
            bumped: bumper::read(moment.after.rotation, moment.pushes, self.bump_impulse),
            over_marker: terrain.is_marked(moment.after.translation.vector),
            beams,
        };
        self.faults.distort(&mut readings);
        readings
    }
}

/// Returns the change of the heading between two poses, in radians; at most half a turn.
fn turned(before: &Isometry2<f64>, after: &Isometry2<f64>) -> f64 {
    let turn = (before.rotation.inverse() * after.rotation).into_inner();
    libm::atan2(turn.im, turn.re)
}

/// Returns the unit vector along the heading of a rotation.
fn ahead(rotation: UnitComplex<f64>) -> Vector2<f64> {
    Vector2::new(rotation.re, rotation.im)
}
