//! The robot without its pilot: the caller drives the wheels, step by step.

use nalgebra::{Complex, Isometry2, Rotation2, UnitComplex, Vector2};

use super::cell_from_position;
use super::motion::within;
use super::robot::Robot;
use crate::arena::{View, first_cell};
use crate::world::Cell;
use xcscr_sensing::cast;

/// A [`Robot`] whose wheels are driven directly, one physics step of 50 ms at a time.
pub struct WheelDrive {
    robot: Robot,
    cell: Cell,
    /// The number of the episode, from 1; 0 before the first one.
    episode: u32,
}

impl WheelDrive {
    /// Takes over a new robot.
    pub fn new(robot: Robot) -> Self {
        Self {
            cell: first_cell(robot.maze()),
            robot,
            episode: 0,
        }
    }

    /// Returns the observable state: the path and the collisions of the last step.
    pub fn view(&self) -> View<'_> {
        self.robot.view(self.cell)
    }

    /// Begins an episode: puts the robot at rest in the middle of a free cell. The heading is in radians,
    /// counter-clockwise from the grid's x axis.
    pub fn reset(&mut self, start: Cell, heading_rad: f64) {
        self.episode = self.episode.saturating_add(1);
        let (sine, cosine) = libm::sincos(heading_rad);
        let heading = UnitComplex::new_unchecked(Complex::new(cosine, sine));
        let middle = self.robot.maze().centre_in_grid(start);
        self.robot
            .put_down(Isometry2::from_parts(middle.into(), heading), self.episode);
        self.robot.begin_action();
        self.cell = start;
    }

    /// Drives for one step of 50 ms. The motors follow the commanded speeds of the left and right
    /// rim, in m/s, with their lag and limited acceleration. The floor's friction limits the force
    /// of the wheels.
    pub fn step(&mut self, rims_mps: [f64; 2]) {
        let most = self.robot.params().max_speed_mps;
        self.robot.begin_trace();
        self.robot.roll(rims_mps.map(|speed| within(speed, most)));
        let position_m = self.robot.pose().translation.vector.into();
        self.cell = cell_from_position(self.robot.maze(), position_m, self.cell);
    }

    /// Returns the largest speed of a rim in m/s.
    pub fn max_speed_mps(&self) -> f64 {
        self.robot.params().max_speed_mps
    }

    /// Returns the distances in metres to the first wall, at most `limit_m`, in `beams` evenly
    /// spaced directions. The first is straight ahead, the others follow counter-clockwise.
    pub fn ranges_m(&self, beams: usize, limit_m: f64) -> Vec<f64> {
        let pose = self.robot.pose();
        let apart_rad = std::f64::consts::TAU / beams.max(1) as f64;
        let ranges = (0..beams).map(|beam| {
            let turned = Rotation2::new(beam as f64 * apart_rad);
            let direction = pose.rotation * (turned * Vector2::x());
            let origin = pose.translation.vector;
            cast(self.robot.maze(), origin, direction, limit_m).unwrap_or(limit_m)
        });
        ranges.collect()
    }

    /// Returns the straight-line distance to the middle of the nearest goal cell in metres, and its
    /// bearing in radians, counter-clockwise from straight ahead.
    pub fn goal(&self) -> (f64, f64) {
        let (pose, maze) = (self.robot.pose(), self.robot.maze());
        let seen = maze.goals().iter().map(|&cell| {
            let middle = maze.centre_in_grid(cell);
            let ahead = pose.inverse_transform_point(&middle).coords;
            (ahead.norm(), libm::atan2(ahead.y, ahead.x))
        });
        let nearest = seen.reduce(|best, one| if one.0 < best.0 { one } else { best });
        nearest.expect("every maze has a goal")
    }

    /// Returns the total impulse of the wall collisions in the last step, in newton-seconds.
    pub fn impulse_n_s(&self) -> f64 {
        self.robot.impulse_n_s()
    }

    /// Sets the clock to nanoseconds since the trial began; a reset must follow.
    pub fn set_clock(&mut self, time_ns: u64) {
        self.robot.set_clock(time_ns);
    }

    /// Restarts the clock and the noise, as with a new robot of this seed; a reset must follow.
    pub fn reseed(&mut self, seed: u64) {
        self.robot.reseed(seed);
    }

    /// Returns true if the middle of the robot is in a goal cell.
    pub fn has_arrived(&self) -> bool {
        self.robot.maze().is_goal(self.cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::PhysicsParams;
    use crate::world::Maze;

    /// Returns a robot without noise at the western end of a corridor of three cells of 1 m.
    fn corridor() -> WheelDrive {
        let world = br######"{ "rows": ["#####", "#S.G#", "#####"] }"######;
        let maze = Maze::from_json(world, "corridor.json").unwrap();
        let params = PhysicsParams {
            noise: 0.0,
            ..PhysicsParams::default()
        };
        let start = Cell { col: 1, row: 1 };
        let mut drive = WheelDrive::new(Robot::new(maze, params, 1).unwrap());
        drive.reset(start, 0.0);
        drive
    }

    #[test]
    fn equal_wheels_drive_straight_to_the_goal_and_stop_at_the_wall() {
        let mut drive = corridor();
        assert!((drive.goal().0 - 2.0).abs() < 1e-6 && drive.goal().1.abs() < 1e-6);
        let mut arrived = None;
        for step in 0..100 {
            drive.step([1.0, 1.0]);
            arrived = arrived.or(drive.has_arrived().then_some(step));
        }
        // 1.5 m to the goal cell at 1 m/s, and a few steps to accelerate.
        assert!((28..36).contains(&arrived.unwrap()), "{arrived:?}");
        let at = drive.view().now().robot_in_map.translation;
        assert!(
            (at.x - 3.7).abs() < 0.02 && (at.y - 1.5).abs() < 1e-3,
            "{at}"
        );
    }

    #[test]
    fn opposite_wheels_turn_on_the_spot() {
        let mut drive = corridor();
        (0..10).for_each(|_| drive.step([-0.2, 0.2]));
        let pose = drive.view().now().robot_in_map;
        assert!(pose.rotation.angle() > 0.3, "{pose}");
        assert!((pose.translation.x - 1.5).abs() < 1e-3, "{pose}");
    }

    #[test]
    fn ranges_begin_straight_ahead_and_go_counter_clockwise() {
        let mut drive = corridor();
        drive.reset(Cell { col: 1, row: 1 }, std::f64::consts::FRAC_PI_2);
        let ranges = drive.ranges_m(4, 2.0);
        // The robot faces north. The walls to the north, west and south are half a cell away; the goal is to the east.
        let expected = [0.5, 0.5, 0.5, 2.0];
        for (range, expected) in ranges.iter().zip(expected) {
            assert!((range - expected).abs() < 1e-6, "{ranges:?}");
        }
    }

    #[test]
    fn the_same_seed_and_speeds_give_the_same_bits() {
        let world = br######"{ "rows": ["#####", "#S.G#", "#####"] }"######;
        let path = || {
            let maze = Maze::from_json(world, "corridor.json").unwrap();
            let start = Cell { col: 1, row: 1 };
            let robot = Robot::new(maze, PhysicsParams::default(), 7).unwrap();
            let mut drive = WheelDrive::new(robot);
            drive.reset(start, 0.3);
            (0..50).for_each(|step| drive.step([0.4, 0.1 * f64::from(step % 9)]));
            drive.view().now().robot_in_map
        };
        assert_eq!(path(), path());
    }
}
