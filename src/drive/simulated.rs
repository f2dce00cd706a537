//! The simulated robot as seen from outside: commands in, odometry, gyro and scans out.

use nalgebra::Isometry2;
use xcscr_sensing::STEP_NS;

use super::readings::{Imu, Odometry, Scan};
use super::setup::in_grid;
use crate::arena::{Localisation, PhysicsError, PhysicsParams, Robot, Speeds};
use crate::record::rolled;
use crate::world::Maze;

/// The duration of a command in nanoseconds of simulated time. The robot then stops.
const COMMAND_NS: u64 = 500_000_000;
/// The number of the only episode.
const ONLY_EPISODE: u32 = 1;

/// The readings after a step of 50 ms.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedReadings {
    /// Simulated time in nanoseconds.
    pub time_ns: u64,
    /// Dead reckoning from the wheels alone.
    pub odometry: Odometry,
    /// The gyro reading; `None` for a robot without a gyro.
    pub imu: Option<Imu>,
    /// The lidar turn that ended in this step.
    pub scan: Option<Scan>,
}

/// The physics arena as a robot that is controlled by speeds.
pub struct SimulatedRobot {
    robot: Robot,
    in_odom: Isometry2<f64>,
    command: Speeds,
    was_at_rest: bool,
    commanded_ns: Option<u64>,
    /// The current lidar turn: the time of its first beam, and the ranges so far.
    turn: Option<(u64, Vec<f64>)>,
}

impl SimulatedRobot {
    /// Creates a robot at rest at a pose in the map frame: x and y in metres and the heading in
    /// radians. `None` places it in the middle of the start cell. All noise derives from `seed`.
    ///
    /// # Errors
    /// Returns an error if a setting is out of range, or the world is not valid in physics.
    pub fn new(
        maze: Maze,
        params: &PhysicsParams,
        seed: u64,
        start: Option<[f64; 3]>,
    ) -> Result<Self, PhysicsError> {
        let cell = maze.starts().next().unwrap_or(maze.goals()[0]);
        let middle = maze.centre_in_grid(cell);
        let pose = match start {
            None => Isometry2::translation(middle.x, middle.y),
            Some(start) => in_grid(&maze, start),
        };
        let params = PhysicsParams {
            localisation: Localisation::Estimated,
            ..params.clone()
        };
        let mut robot = Robot::new(maze, params, seed)?;
        robot.put_down(pose, ONLY_EPISODE);
        Ok(Self {
            robot,
            in_odom: Isometry2::identity(),
            command: Speeds::REST,
            was_at_rest: true,
            commanded_ns: None,
            turn: None,
        })
    }

    /// Sets the command, which is in effect for half a second of simulated time.
    pub fn command(&mut self, speeds: Speeds) {
        self.command = speeds;
        self.commanded_ns = Some(self.robot.time_ns());
    }

    /// Returns the true pose in the map frame, in metres.
    pub fn true_pose(&self) -> Isometry2<f64> {
        self.robot.maze().pose_in_map(self.robot.pose())
    }

    /// Returns the settings of the robot.
    pub fn physics(&self) -> &PhysicsParams {
        self.robot.params()
    }

    /// Moves the robot to a pose of the grid frame without any sensor reading.
    pub fn kidnap(&mut self, pose: Isometry2<f64>) {
        self.robot.put_down(pose, ONLY_EPISODE);
    }

    /// Returns true if the robot is in a goal cell.
    pub fn is_at_goal(&self) -> bool {
        let at = self.robot.pose().translation.vector.into();
        let maze = self.robot.maze();
        maze.cell_in_grid(at).is_some_and(|cell| maze.is_goal(cell))
    }

    /// Returns the total impulse of the collisions during the last step, in newton-seconds.
    pub fn impulse_n_s(&self) -> f64 {
        self.robot.impulse_n_s()
    }

    /// Simulates 50 ms.
    pub fn step(&mut self) -> SimulatedReadings {
        let begin_ns = self.robot.time_ns();
        let is_fresh = |at_ns: u64| begin_ns - at_ns < COMMAND_NS;
        if !self.commanded_ns.is_some_and(is_fresh) {
            self.command = Speeds::REST;
        }
        let is_at_rest = self.command == Speeds::REST;
        if self.was_at_rest && !is_at_rest {
            self.robot.begin_action();
        }
        self.was_at_rest = is_at_rest;
        let params = self.robot.params();
        let (base_m, beams) = (params.wheel_base_m, params.lidar.beams);
        self.robot.begin_trace();
        let measured = self.robot.step(self.command);
        let readings = measured.readings().expect("this robot has sensors");
        let moved = rolled([0.0; 2], readings.rolled_m, base_m);
        let turned_rad = readings.turned_rad;
        let mut ended = None;
        for beam in readings.beams {
            let time_ns = begin_ns + (beam.moment * STEP_NS as f64).round() as u64;
            if beam.number == 0 {
                self.turn = Some((time_ns, Vec::with_capacity(beams as usize)));
            }
            let Some((_, ranges_m)) = &mut self.turn else {
                continue;
            };
            ranges_m.push(beam.range_m.unwrap_or(f64::INFINITY));
            if beam.number + 1 == beams {
                ended = self.turn.take();
            }
        }
        let rate = |change: f64| change / (STEP_NS as f64 * 1e-9);
        self.in_odom *= moved;
        self.in_odom.rotation.renormalize();
        let time_ns = self.robot.time_ns();
        SimulatedReadings {
            time_ns,
            odometry: Odometry {
                stamp_ns: time_ns,
                frame: "odom".to_owned(),
                child_frame: "base_link".to_owned(),
                pose: self.in_odom,
                speeds: Speeds {
                    forward_mps: rate(moved.translation.x),
                    turn_radps: rate(moved.rotation.angle()),
                },
            },
            imu: turned_rad.map(|turned_rad| Imu {
                stamp_ns: time_ns,
                turn_radps: rate(turned_rad),
            }),
            scan: ended.map(|(stamp_ns, ranges_m)| {
                Scan::of_turn(stamp_ns, &self.robot.params().lidar, ranges_m)
            }),
        }
    }
}
