//! A robot that localises itself: connects the sensors and the onboard computer.
//!
//! Only this module has access to both sides. The true state goes into the sensors, the readings go
//! to the onboard computer, and the computer's command goes to the wheels.

use nalgebra::{Isometry2, Vector2};

use super::discretiser::cell_from_position;
use super::motion::Speeds;
use super::params::{Localisation, PhysicsParams};
use super::pilot::{ManeuverEnd, Pilot};
use super::{PhysicsArena, STEP_NS};
use crate::arena::{Beam, Estimate, Outcome, Sensed};
use crate::streams::StreamName;
use crate::world::{Cell, Direction, Maze};
use xcs::random::Stream;
use xcscr_sensing::{Moment, Onboard, Readings, Return, Sensors, Streams};

/// Number of lidar turns before the first action of an episode. In one turn only two beams may pass
/// a narrow gap, and losing one of them must not close the gap.
const TURNS_BEFORE_START: u64 = 2;

/// Sensors, onboard computer, and the data shown to observers.
pub(super) struct Sensing {
    sensors: Sensors,
    pilot: Pilot,
    steps_per_turn: u64,
    /// The beams of one step.
    returns: Vec<Return>,
    estimates: Vec<Estimate>,
    beams: Vec<Beam>,
}

impl Sensing {
    /// Creates the sensors and the onboard computer of the robot with `seed`. Returns `None` if the
    /// robot gets the true pose.
    pub(super) fn new(params: &PhysicsParams, maze: &Maze, seed: u64) -> Option<Box<Self>> {
        let robot = params.robot(maze.cell_size_m());
        let senses = || Self {
            sensors: Sensors::new(&robot, streams(seed)),
            pilot: Pilot::new(params, maze),
            steps_per_turn: params.lidar.steps_per_turn(),
            returns: Vec::new(),
            estimates: Vec::new(),
            beams: Vec::new(),
        };
        (params.localisation == Localisation::Estimated).then(|| Box::new(senses()))
    }

    /// Returns the estimated pose and speeds of the robot.
    fn estimated(&self) -> (Isometry2<f64>, Speeds) {
        let onboard = self.pilot.onboard();
        let (forward_mps, turn_radps) = onboard.speeds();
        let speeds = Speeds {
            forward_mps,
            turn_radps,
        };
        (onboard.estimate().0, speeds)
    }

    /// Clears the data shown to observers of the last action.
    fn begin_records(&mut self, maze: &Maze) {
        self.estimates.clear();
        self.beams.clear();
        self.record_estimate(maze);
    }

    /// Records the current estimate, in the map frame.
    fn record_estimate(&mut self, maze: &Maze) {
        let (robot_in_grid, mut covariance) = self.pilot.onboard().estimate();
        if let Some(grid) = maze.grid_in_map() {
            let turn = grid.rotation.to_rotation_matrix().into_inner();
            let turn = turn.to_homogeneous();
            covariance = turn * covariance * turn.transpose();
        }
        self.estimates.push(Estimate {
            robot_in_map: maze.pose_in_map(robot_in_grid),
            covariance,
        });
    }

    /// Records the beams of the step that began at `start_ns`.
    fn record_beams(&mut self, start_ns: u64) {
        let beams = self.returns.iter().map(|beam| Beam {
            time_ns: start_ns + (beam.moment * STEP_NS as f64) as u64,
            bearing: beam.bearing,
            range_m: beam.range_m,
        });
        self.beams.extend(beams);
    }
}

impl PhysicsArena {
    /// Puts the robot down, and lets its lidar turn before the first decision.
    pub(super) fn look_round(&mut self, sensing: &mut Sensing) {
        sensing.sensors.reset();
        sensing.pilot.put_down(self.motion().pose);
        sensing.begin_records(&self.maze);
        for _ in 0..TURNS_BEFORE_START * sensing.steps_per_turn {
            self.sense_step(sensing, Vector2::x());
        }
    }

    /// Executes one action of a robot that localises itself.
    pub(super) fn act_with_sensors(
        &mut self,
        sensing: &mut Sensing,
        direction: Direction,
    ) -> Outcome {
        let (pose, speeds) = sensing.estimated();
        sensing.pilot.begin(direction, pose, speeds);
        sensing.begin_records(&self.maze);
        let in_time = self.perform_with_sensors(sensing);
        let (onboard, along) = (sensing.pilot.onboard(), sensing.pilot.along());
        let at_goal = onboard.over_marker();
        self.cell = self.estimated_cell(onboard);
        match sensing.pilot.end() {
            Some(ManeuverEnd::Blocked) if in_time => {
                let against = self.maze.vector_in_map(-along);
                let impulse_ns = Some(self.hits.frontal_impulse_ns(against));
                Outcome::Collided { impulse_ns }
            }
            _ if at_goal => Outcome::ReachedGoal,
            Some(ManeuverEnd::Reached) if in_time => Outcome::Moved,
            _ => Outcome::Stalled,
        }
    }

    /// Drives until the manoeuvre ends and the lidar has completed a turn. Returns true if both
    /// happened in time.
    fn perform_with_sensors(&mut self, sensing: &mut Sensing) -> bool {
        let bias = self.noise.wheel_bias();
        for step in 0..self.max_steps() {
            let (pose, speeds) = sensing.estimated();
            let slips = sensing.pilot.onboard().slips();
            let command = match sensing.pilot.command(pose, speeds) {
                Some(command) => command,
                None if step < sensing.steps_per_turn => Speeds::REST,
                None => return true,
            };
            let motion = self.motion();
            self.drive(command, &motion, bias, slips);
            self.sense_step(sensing, sensing.pilot.along());
            if sensing.pilot.is_bumped() && sensing.pilot.travel_direction(pose).is_some() {
                sensing.pilot.back_off();
            }
        }
        false
    }

    /// Simulates one step, and passes the sensor readings to the onboard computer.
    fn sense_step(&mut self, sensing: &mut Sensing, along: Vector2<f64>) {
        let start_ns = self.time_ns();
        let readings = self.read_step(&mut sensing.sensors, &mut sensing.returns, along);
        sensing.pilot.sense(&readings);
        sensing.record_beams(start_ns);
        sensing.record_estimate(&self.maze);
    }

    /// Simulates one step, and returns the sensor readings. The beams go to `returns`.
    pub(super) fn read_step<'a>(
        &mut self,
        sensors: &mut Sensors,
        returns: &'a mut Vec<Return>,
        along: Vector2<f64>,
    ) -> Readings<'a> {
        let (step, before) = (self.steps, self.motion().pose);
        self.step(along);
        let moment = Moment {
            step,
            before,
            after: self.motion().pose,
            travel_m: self.wheels.travel_m,
            pushes: self.simulation.pushes(),
        };
        sensors.read(&self.maze, &moment, returns)
    }

    /// Returns the estimated cell in the maze, for observers. An estimate outside the free cells
    /// leaves the last cell.
    fn estimated_cell(&self, onboard: &Onboard) -> Cell {
        let position_m = onboard.estimate().0.translation.vector.into();
        cell_from_position(&self.maze, position_m, self.cell)
    }

    /// Returns the estimated cell in the grid, free or not.
    fn estimated_grid_cell(&self, onboard: &Onboard) -> Cell {
        let [east, north] = onboard.cell();
        let (width, height) = (i32::from(self.maze.width()), i32::from(self.maze.height()));
        Cell {
            // Both are below the maze's size, which is a u16.
            col: east.clamp(0, width - 1) as u16,
            row: (height - 1).saturating_sub(north).clamp(0, height - 1) as u16,
        }
    }

    /// Returns the sensor data for observers and percepts.
    pub(super) fn sensed(&self) -> Option<Sensed<'_>> {
        let sensing = self.sensing.as_ref()?;
        let cell_of = |pose: Isometry2<f64>| self.maze.cell_in_grid(pose.translation.vector.into());
        let (truth, estimate) = (self.motion().pose, sensing.pilot.onboard().estimate().0);
        Some(Sensed {
            surroundings: sensing.pilot.onboard().surroundings(),
            obstacles: sensing.pilot.onboard().obstacles(),
            cell: self.estimated_grid_cell(sensing.pilot.onboard()),
            estimates: &sensing.estimates,
            beams: &sensing.beams,
            mislocalised: cell_of(truth) != cell_of(estimate),
        })
    }
}

/// Returns the random streams of the sensors of the robot with `seed`.
pub(super) fn streams(seed: u64) -> Streams {
    Streams {
        lidar: Stream::new(seed, StreamName::Lidar),
        encoders: Stream::new(seed, StreamName::Encoders),
        gyro: Stream::new(seed, StreamName::Gyro),
    }
}
