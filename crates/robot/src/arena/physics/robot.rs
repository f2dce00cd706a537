//! The simulated robot: commanded speeds in, sensor readings out, in steps of 50 ms.

use nalgebra::{Isometry2, Point2, Vector2};

use super::cautious::profile;
use super::contact::{Hits, is_frontal};
use super::controller::Maneuver;
use super::motion::Speeds;
use super::noise::Noise;
use super::params::{FRICTION, PhysicsParams};
use super::simulation::{Simulation, State, pose_of};
use super::wheels::{Motion, Wheels, true_motion};
use super::{Localisation, PhysicsError, blocks, fit, simulation};
use crate::arena::{Contact, Sample, View, first_cell};
use crate::streams::StreamName;
use crate::world::{Cell, Maze};
use xcs::random::Stream;
use xcscr_sensing::{Moment, Push, Readings, Return, STEP_NS, Sensors, Streams};

/// What a robot measures in a step of 50 ms.
pub enum Measured<'a> {
    /// The readings of its sensors.
    Sensors(Readings<'a>),
    /// What the simulation knows in place of them ([`Localisation::GroundTruth`]).
    GroundTruth {
        /// The true pose in the grid frame, with some noise.
        pose: Isometry2<f64>,
        /// The true speeds.
        speeds: Speeds,
        /// The pushes of walls.
        pushes: &'a [Push],
    },
}

impl<'a> Measured<'a> {
    /// Returns the readings of the sensors; `None` with ground truth.
    pub fn readings(self) -> Option<Readings<'a>> {
        match self {
            Self::Sensors(readings) => Some(readings),
            Self::GroundTruth { .. } => None,
        }
    }

    /// Returns true if a wall stops a robot that follows a manoeuvre: by the bumper that leads, or by
    /// a push against the direction of travel.
    pub(super) fn is_hit(&self, maneuver: &Maneuver) -> bool {
        match self {
            Self::Sensors(readings) => {
                let [front, rear] = readings.bumped;
                if maneuver.front_leads() { front } else { rear }
            }
            Self::GroundTruth { pushes, .. } => {
                let along = maneuver.along();
                pushes.iter().any(|push| is_frontal(push.normal, along))
            }
        }
    }
}

/// A differential-drive robot in a maze: body, wheels, floor, walls, sensors and noise. It knows no
/// cells and takes no decisions; whoever drives it commands speeds, step by step.
///
/// All drivers use this robot: the arena, the evaluation of a policy and `simulate` by
/// [`step`](Self::step), and the wheel environment, which has no use for readings, by its wheels.
pub struct Robot {
    maze: Maze,
    params: PhysicsParams,
    /// The settings for cautious driving.
    careful: PhysicsParams,
    is_gentle: bool,
    simulation: Simulation,
    /// The initial state of the engine, restored whenever the robot is put down.
    initial: State,
    wheels: Wheels,
    pub(super) noise: Noise,
    /// The share by which each wheel turns too fast during this action.
    bias: [f64; 2],
    sensors: Sensors,
    /// The beams of the last step.
    returns: Vec<Return>,
    /// The true pose before the last step, in the grid frame.
    before: Isometry2<f64>,
    /// Physics steps since the trial began.
    pub(super) steps: u64,
    trace: Vec<Sample>,
    hits: Hits,
}

impl Robot {
    /// Creates a robot at rest in the first start cell. All noise derives from `seed`.
    ///
    /// # Errors
    /// When a setting is out of range, or the world cannot be simulated: joined edges, eight moves,
    /// cells too small for the robot, too many walls, or a side of more than 4,096 m.
    pub fn new(maze: Maze, params: PhysicsParams, seed: u64) -> Result<Self, PhysicsError> {
        params.check()?;
        let maze = fit::fitted(&maze, &params)?;
        let walls = simulation::walls(&blocks(&maze)?, maze.everything_solid());
        let start = Isometry2::from(maze.centre_in_grid(first_cell(&maze)).coords);
        let simulation = Simulation::new(walls, pose_of(&start), &params);
        let mut robot = Self {
            initial: simulation.state(),
            noise: Noise::new(&params, Stream::new(seed, StreamName::Physics)),
            sensors: sensors(&maze, &params, seed),
            simulation,
            wheels: Wheels::default(),
            bias: [0.0; 2],
            returns: Vec::new(),
            before: start,
            steps: 0,
            trace: Vec::new(),
            hits: Hits::default(),
            careful: params.careful(),
            is_gentle: false,
            params,
            maze,
        };
        robot.begin_trace();
        Ok(robot)
    }

    /// Places the robot at rest at a pose of the grid frame, in metres, in an episode counted from 1. Number 0 comes
    /// before the first episode. Time continues.
    pub fn put_down(&mut self, pose: Isometry2<f64>, episode: u32) {
        self.simulation.set_state(&self.initial);
        self.simulation
            .body_mut()
            .set_position(pose_of(&pose), true);
        self.wheels = Wheels::default();
        self.sensors.reset(episode);
        self.begin_trace();
    }

    /// Begins an action: the wheels get a new scale error.
    pub fn begin_action(&mut self) {
        self.bias = self.noise.wheel_bias();
    }

    /// Starts a new path and a new list of collisions at the current pose.
    pub fn begin_trace(&mut self) {
        self.hits.clear();
        self.trace.clear();
        self.trace.push(self.sample());
    }

    /// Makes the motors accelerate as gently as the settings say for wheels that slip, or as usual.
    ///
    /// Only the arena's robot can. A robot that is reached by speeds alone, as `simulate`, keeps its
    /// usual motors. A pilot that ramped its speeds instead was worse in `maze5-wet` at noise 3: of
    /// 20,000 moves 229 and not 134 went wrong, and 389 if it ramped from the measured speeds.
    pub(super) fn accelerate_gently(&mut self, gently: bool) {
        self.is_gentle = gently;
    }

    /// Drives for 50 ms at the commanded speeds, limited by the robot's settings. Returns what it
    /// measures.
    pub fn step(&mut self, speeds: Speeds) -> Measured<'_> {
        self.roll(speeds.limited(&self.params).rims_mps(&self.params));
        self.measure()
    }

    /// Drives for 50 ms. The motors follow the commanded speeds of the left and right rim with their
    /// lag and limited acceleration. The floor's friction limits the force of the wheels.
    pub(super) fn roll(&mut self, rims_mps: [f64; 2]) {
        let motion = self.motion();
        let [left, right] = self.noise.wheel_noise();
        let excess = [self.bias[0] + left, self.bias[1] + right];
        let limits = profile(&self.params, &self.careful, self.is_gentle);
        self.wheels.follow(rims_mps, limits);
        let friction = self.friction(&motion);
        let body = self.simulation.body_mut();
        self.wheels
            .push(body, &motion, excess, friction, &self.params);
        self.advance();
    }

    /// Lets 50 ms pass without a command. Returns what the robot measures.
    pub fn wait(&mut self) -> Measured<'_> {
        self.advance();
        self.measure()
    }

    /// Measures the last step.
    fn measure(&mut self) -> Measured<'_> {
        let motion = self.motion();
        let pushes = self.simulation.pushes();
        if self.params.localisation == Localisation::GroundTruth {
            return Measured::GroundTruth {
                pose: self.noise.measure(&motion.pose),
                speeds: Speeds {
                    forward_mps: motion.forward_mps,
                    turn_radps: motion.turn_radps,
                },
                pushes,
            };
        }
        let moment = Moment {
            step: self.steps - 1,
            before: self.before,
            after: motion.pose,
            travel_m: self.wheels.travel_m,
            pushes,
        };
        let (sensors, returns) = (&mut self.sensors, &mut self.returns);
        Measured::Sensors(sensors.read(&self.maze, &moment, returns))
    }

    /// Returns the impulse in newton-seconds of the collisions of this path with walls across the
    /// unit vector `along` of the grid frame.
    pub(super) fn frontal_impulse_n_s(&self, along: Vector2<f64>) -> f64 {
        self.hits
            .frontal_impulse_n_s(self.maze.vector_in_map(along))
    }

    /// Simulates one step.
    fn advance(&mut self) {
        self.before = self.motion().pose;
        self.steps += 1;
        let time_ns = self.time_ns();
        let (pushes, body) = self.simulation.advance(self.maze.everything_solid());
        let centre = true_motion(body).pose.translation.vector;
        for push in pushes {
            let touched = centre + push.normal * self.params.radius_m;
            self.hits.add(Contact {
                time_ns,
                point_in_map: self.maze.point_in_map(touched.into()),
                normal_in_map: self.maze.vector_in_map(push.normal),
                impulse_n_s: push.impulse_n_s,
            });
        }
        self.trace.push(self.sample());
    }

    /// Returns the friction of the floor below the left and right wheel.
    fn friction(&self, motion: &Motion) -> [f64; 2] {
        let usual = FRICTION;
        if !self.maze.has_floor() {
            return [usual; 2];
        }
        let half = self.params.wheel_base_m / 2.0;
        [half, -half].map(|left| {
            let wheel = motion.pose * Point2::new(0.0, left);
            let cell = self.maze.cell_in_grid(wheel);
            cell.and_then(|cell| self.maze.friction(cell))
                .unwrap_or(usual)
        })
    }

    fn sample(&self) -> Sample {
        Sample {
            time_ns: self.time_ns(),
            robot_in_map: self.maze.pose_in_map(self.motion().pose),
            wheel_travel_m: self.wheels.travel_m,
        }
    }

    fn motion(&self) -> Motion {
        true_motion(self.simulation.body())
    }

    /// Returns the true pose in the grid frame, in metres.
    pub fn pose(&self) -> Isometry2<f64> {
        self.motion().pose
    }

    /// Returns the world, with the moves in which this robot fits.
    pub fn maze(&self) -> &Maze {
        &self.maze
    }

    /// Returns the settings of the robot.
    pub fn params(&self) -> &PhysicsParams {
        &self.params
    }

    /// Returns the beams of the last step; nothing with ground truth.
    pub(super) fn returns(&self) -> &[Return] {
        &self.returns
    }

    /// Returns the simulated time since the trial began, in nanoseconds.
    pub fn time_ns(&self) -> u64 {
        self.steps * STEP_NS
    }

    /// Returns what can be seen of the robot in `cell` from outside: its path and its collisions
    /// since [`begin_trace`](Self::begin_trace).
    pub fn view(&self, cell: Cell) -> View<'_> {
        View {
            maze: &self.maze,
            cell,
            trace: &self.trace,
            contacts: self.hits.contacts(),
            sensed: None,
            executed: None,
            flipped: None,
            wheels_mps: None,
        }
    }

    /// Returns the total impulse of the collisions since [`begin_trace`](Self::begin_trace), in
    /// newton-seconds.
    pub fn impulse_n_s(&self) -> f64 {
        let impulses = self
            .hits
            .contacts()
            .iter()
            .map(|contact| contact.impulse_n_s);
        // The sum of no numbers is minus zero.
        impulses.fold(0.0, |total, one| total + one)
    }

    /// Sets the clock to nanoseconds since the trial began.
    pub fn set_clock(&mut self, time_ns: u64) {
        self.steps = time_ns / STEP_NS;
        self.begin_trace();
    }

    /// Restarts the clock and all noise, as in a new robot with this seed.
    pub fn reseed(&mut self, seed: u64) {
        self.noise.stream = Stream::new(seed, StreamName::Physics);
        self.sensors = sensors(&self.maze, &self.params, seed);
        self.steps = 0;
    }
}

/// Creates the sensors of the robot with `seed`.
fn sensors(maze: &Maze, params: &PhysicsParams, seed: u64) -> Sensors {
    let streams = Streams {
        lidar: Stream::new(seed, StreamName::Lidar),
        encoders: Stream::new(seed, StreamName::Encoders),
        gyro: Stream::new(seed, StreamName::Gyro),
    };
    Sensors::new(&params.robot(maze.cell_size_m()), streams)
}
