//! What a robot that knows only what it senses tells about itself.

use nalgebra::{Isometry2, Matrix3, UnitComplex};
use xcscr_sensing::Surroundings;

use crate::world::Cell;

/// Where the robot believes to be, and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The pose in the map frame; metres, heading counted from the x axis.
    pub robot_in_map: Isometry2<f64>,
    /// Covariance of x, y (metres) and heading (radians).
    pub covariance: Matrix3<f64>,
}

impl Estimate {
    /// By how much this estimate misses the true pose: the distance in metres, and the absolute
    /// difference of the headings in radians.
    pub fn error(&self, truth: &Isometry2<f64>) -> (f64, f64) {
        let [x, y, turn] = self.difference(truth);
        ((x * x + y * y).sqrt(), turn.abs())
    }

    /// The normalised estimation error squared: about 3 on average for a robot that is as sure as
    /// it may be, more for one that is too sure (Bar-Shalom, Li and Kirubarajan 2001, 5.4).
    /// `None` when the covariance cannot be inverted.
    pub fn nees(&self, truth: &Isometry2<f64>) -> Option<f64> {
        let difference = nalgebra::Vector3::from(self.difference(truth));
        let inverse = self.covariance.try_inverse()?;
        Some((difference.transpose() * inverse * difference)[0])
    }

    fn difference(&self, truth: &Isometry2<f64>) -> [f64; 3] {
        let believed = &self.robot_in_map;
        let missing = truth.translation.vector - believed.translation.vector;
        let turn = (believed.rotation.inverse() * truth.rotation).into_inner();
        [missing.x, missing.y, libm::atan2(turn.im, turn.re)]
    }
}

/// One beam of the lidar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Simulation time since the trial began, in nanoseconds.
    pub time_ns: u64,
    /// Its direction, counted from the robot's heading.
    pub bearing: UnitComplex<f64>,
    /// The measured range in metres; minus infinity when something is nearer than
    /// [`nearest_m`](super::LidarParams::nearest_m), and `None` when nothing came back.
    pub range_m: Option<f64>,
}

/// What the robot sensed and believed during the last reset or action.
#[derive(Debug, Clone, Copy)]
pub struct Sensed<'a> {
    /// The cells around it, as it made them out.
    pub surroundings: &'a Surroundings,
    /// The cell that it believes to stand in, of all cells of the grid: it knows how large the grid
    /// is, but not where walls are, and may believe to stand in one.
    pub cell: Cell,
    /// Where it believed to be: one for each moment of the path.
    pub estimates: &'a [Estimate],
    /// The beams of its lidar, oldest first.
    pub beams: &'a [Beam],
    /// Is it mislocalised: is it in another cell than its estimate, which may lie in a wall or outside
    /// of the maze? Only an observer can know.
    pub lost: bool,
}
