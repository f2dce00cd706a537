//! Sensor readings and estimates of a robot that localises itself.

use nalgebra::{Isometry2, Matrix3, UnitComplex, Vector2};
use xcscr_sensing::{Obstacles, Surroundings};

use crate::world::{Cell, Direction, Maze};

/// The estimated pose of the robot, and its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The pose in the map frame; metres, heading measured from the x axis.
    pub robot_in_map: Isometry2<f64>,
    /// Covariance of x, y (metres) and heading (radians).
    pub covariance: Matrix3<f64>,
}

impl Estimate {
    /// Returns the error of this estimate: the distance to the true pose in metres, and the
    /// absolute difference of the headings in radians.
    pub fn error(&self, truth: &Isometry2<f64>) -> (f64, f64) {
        let [x, y, turn] = self.difference(truth);
        ((x * x + y * y).sqrt(), turn.abs())
    }

    /// Returns the normalised estimation error squared. The average is about 3 for a consistent
    /// estimate, and larger for an overconfident one (Bar-Shalom, Li and Kirubarajan 2001, 5.4).
    /// Returns `None` if the covariance is not invertible.
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
    /// The direction, relative to the robot's heading.
    pub bearing: UnitComplex<f64>,
    /// The measured range in metres. Minus infinity when something is nearer than
    /// [`nearest_m`](super::LidarParams::nearest_m), and `None` when nothing came back.
    pub range_m: Option<f64>,
}

/// What the robot has observed around itself since its action began.
#[derive(Debug, Clone, Copy)]
pub struct LocalMap<'a> {
    /// The cells around the robot, as estimated from the lidar.
    pub surroundings: &'a Surroundings,
    /// Evidence about obstacles that are not in the map; nothing in a maze.
    pub obstacles: &'a Obstacles,
    /// The robot's estimated cell in the grid. The robot knows the size of the grid but not its
    /// walls, so this cell may be a wall.
    pub cell: Cell,
}

/// The robot's sensor readings and estimates during the last reset or action.
#[derive(Debug, Clone, Copy)]
pub struct Sensed<'a> {
    /// What it observed.
    pub local_map: LocalMap<'a>,
    /// The estimated poses, one for each moment of the path.
    pub estimates: &'a [Estimate],
    /// The lidar beams, oldest first.
    pub beams: &'a [Beam],
    /// True if the robot is mislocalised, that is, in another cell than its estimate. The estimate
    /// may be in a wall or outside the maze. Only an observer has this information.
    pub mislocalised: bool,
}

/// The width of the path in which obstacles are looked for, as a share of the path that is clear in
/// the map. Noisy beams to the walls beside the path then end outside of it.
const NARROWER: f64 = 0.5;

impl LocalMap<'_> {
    /// Returns true if an obstacle that is not in the map bars a move from the estimated cell.
    pub fn is_blocked(&self, maze: &Maze, direction: Direction) -> bool {
        let (east, south) = direction.offset();
        let from = maze.centre_in_grid(self.cell).coords;
        let way = Vector2::new(east.into(), (-south).into()) * maze.cell_size_m();
        let half_width_m = NARROWER * maze.clear_radius_m().unwrap_or(0.0);
        self.obstacles.are_on_path([from, from + way], half_width_m)
    }
}
