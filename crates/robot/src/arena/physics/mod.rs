//! The maze as a physics simulation: a two-wheeled robot drives from cell to cell.
//!
//! An action is one bounded manoeuvre (`controller`): the robot turns, then drives one cell. When
//! it hits a wall, it backs off to where it came from. The wheels push with the force that the
//! floor's friction allows (`robot`). The engine rapier2d simulates the rest (`simulation`) at 20
//! steps per second. Steps that touch no wall are integrated in closed form (`shortcut`).
//!
//! The robot is localised in one of two ways ([`Localisation`]). *Estimated*: the robot has only
//! its sensor readings. Sensors, estimator and local map are in the crate `xcscr-sensing`. Neither
//! that crate nor `controller` can access the maze or the true pose; `sensing` connects both sides.
//! *Ground truth*: for percepts looked up in the maze, the robot gets its true pose with some noise
//! (`noise`), and `discretiser` looks up the cell.
//!
//! All lengths are in metres and all speeds in m/s, whatever the size of a cell. Inside this folder
//! all poses are in the grid frame: origin in the south-western corner of the grid, x to the east,
//! y to the north. The trait [`Arena`] reports poses in the map frame.

mod agreement;
mod cautious;
mod contact;
mod controller;
mod discretiser;
mod error;
mod fit;
mod motion;
mod noise;
mod params;
mod pilot;
mod robot;
mod sensed_drive;
mod sensing;
mod shortcut;
mod simulation;
mod terrain;
#[cfg(test)]
mod tests;
mod wheel_drive;

use nalgebra::{Point2, Vector2};
use rapier2d::prelude::SharedShape;

pub use agreement::Agreement;
use cautious::profile;
pub use cautious::{CautiousDriving, CautiousParams};
pub use error::PhysicsError;
pub use params::{Localisation, PhysicsParams};
pub use pilot::{ManeuverEnd, Pilot};
pub use sensed_drive::SensedDrive;
pub use wheel_drive::WheelDrive;

use self::contact::{Hits, is_frontal};
use self::controller::Maneuver;
use self::discretiser::cell_from_position;
pub use self::fit::check_fit;
use self::motion::Motion;
pub use self::motion::Speeds;
use self::noise::Noise;
use self::robot::{Wheels, true_motion};
use self::sensing::Sensing;
use self::simulation::{Simulation, State, eastward};
use super::{Arena, Contact, Outcome, Sample, View, first_cell};
use crate::streams::StreamName;
use crate::world::{Block, Cell, Direction, Maze, Moves};
use xcs::Action;
use xcs::random::Stream;
use xcscr_sensing::STEP_S;
pub use xcscr_sensing::{
    BumperParams, EncoderParams, EstimatorParams, FaultParams, GyroParams, LidarParams,
};

/// Duration of a physics step ([`STEP_S`]) in nanoseconds, as an integer so that clocks never
/// drift.
const STEP_NS: u64 = 50_000_000;
/// Solver iterations per step; each is a substep of the motion.
const SOLVER_ITERATIONS: usize = 2;
/// The largest number of wall blocks; the engine needs about a kilobyte for each.
const MAX_BLOCKS: usize = 262_144;
/// The longest side of a world in metres. At this distance the engine's single precision resolves a
/// quarter of a millimetre.
const MAX_EXTENT_M: f64 = 4096.0;

/// A robot in a maze, simulated at 20 Hz. The same maze, settings and noise give bit-identical
/// results.
pub struct PhysicsArena {
    maze: Maze,
    params: PhysicsParams,
    /// The settings for cautious driving.
    careful: PhysicsParams,
    simulation: Simulation,
    /// The initial state of the engine, restored by every reset.
    initial: State,
    wheels: Wheels,
    noise: Noise,
    /// Physics steps since the trial began.
    steps: u64,
    cell: Cell,
    trace: Vec<Sample>,
    hits: Hits,
    /// `None` for a robot that gets the true pose.
    sensing: Option<Box<Sensing>>,
}

impl PhysicsArena {
    /// Creates an arena with the robot in the first start cell. All noise follows from `seed`.
    ///
    /// # Errors
    /// When a setting is out of range, or the world cannot be simulated: joined edges, eight moves,
    /// cells too small for the robot, too many walls, or a side of more than 4,096 m.
    pub fn new(maze: Maze, params: PhysicsParams, seed: u64) -> Result<Self, PhysicsError> {
        params.check()?;
        let maze = fit::fitted(&maze, &params)?;
        let walls = simulation::walls(&blocks(&maze)?, maze.solid());
        Ok(Self::among(walls, maze, params, seed))
    }

    /// Creates an arena from checked settings and prebuilt walls, which may be shared.
    fn among(walls: SharedShape, maze: Maze, params: PhysicsParams, seed: u64) -> Self {
        let cell = first_cell(&maze);
        let pose = eastward(maze.centre_in_grid(cell));
        let simulation = Simulation::new(walls, pose, &params);
        let mut arena = Self {
            initial: simulation.state(),
            noise: Noise::new(&params, Stream::new(seed, StreamName::Physics)),
            sensing: Sensing::new(&params, &maze, seed),
            wheels: Wheels::default(),
            steps: 0,
            cell,
            trace: Vec::new(),
            hits: Hits::default(),
            maze,
            careful: params.careful(),
            params,
            simulation,
        };
        arena.reset(cell);
        arena
    }

    /// Drives until the manoeuvre ends. Returns true if it ended in time.
    fn perform(&mut self, maneuver: &mut Maneuver) -> bool {
        let bias = self.noise.wheel_bias();
        for _ in 0..self.max_steps() {
            let motion = self.motion();
            let seen = self.measure(motion);
            let Some(command) = maneuver.command(&seen, self.profile(false)) else {
                self.update_cell(&seen);
                return true;
            };
            self.drive(command, &motion, bias, false);
            if self.step(maneuver.along()) && maneuver.is_stopped_by_walls(&seen) {
                maneuver.back_off();
            }
        }
        let seen = self.measure(self.motion());
        self.update_cell(&seen);
        false
    }

    /// Returns the number of physics steps after which an action times out.
    fn max_steps(&self) -> u64 {
        (self.params.time_out_s / STEP_S).round() as u64
    }

    /// Returns the driving settings, given whether wheel slip is detected.
    fn profile(&self, slips: bool) -> &PhysicsParams {
        profile(&self.params, &self.careful, slips)
    }

    /// Applies a command to the wheels, and the force of the wheels to the floor.
    fn drive(&mut self, command: Speeds, motion: &Motion, bias: [f64; 2], slips: bool) {
        let [left, right] = self.noise.wheel_noise();
        let excess = [bias[0] + left, bias[1] + right];
        let mut wheels = self.wheels;
        wheels.follow(command, self.profile(slips));
        self.wheels = wheels;
        let friction = self.friction(motion);
        let body = self.simulation.body_mut();
        self.wheels
            .push(body, motion, excess, friction, &self.params);
    }

    /// Returns the friction of the floor below the left and right wheel.
    fn friction(&self, motion: &Motion) -> [f64; 2] {
        let usual = self.params.friction;
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

    /// Simulates one step. Returns true if a wall pushed against the direction `along`.
    fn step(&mut self, along: Vector2<f64>) -> bool {
        self.steps += 1;
        let time_ns = self.time_ns();
        let mut frontal = false;
        let (pushes, body) = self.simulation.advance(self.maze.solid());
        let centre = true_motion(body).pose.translation.vector;
        for push in pushes {
            frontal |= is_frontal(push.normal, along);
            let touched = centre + push.normal * self.params.radius_m;
            let contact = Contact {
                time_ns,
                point_in_map: self.maze.point_in_map(touched.into()),
                normal_in_map: self.maze.vector_in_map(push.normal),
                impulse_ns: push.impulse_ns,
            };
            self.hits.add(contact);
        }
        self.trace.push(self.sample());
        frontal
    }

    /// Returns the outcome of a manoeuvre from `home` toward `wanted`.
    fn outcome(&self, maneuver: &Maneuver, arrived: bool, home: Cell, wanted: Cell) -> Outcome {
        if arrived && maneuver.backs_off() && self.cell == home {
            let along = self.maze.vector_in_map(-maneuver.along());
            let impulse_ns = self.hits.frontal_impulse_ns(along);
            return Outcome::Collided {
                impulse_ns: Some(impulse_ns),
            };
        }
        if self.maze.is_goal(self.cell) {
            return Outcome::ReachedGoal;
        }
        if arrived && self.cell == wanted {
            Outcome::Moved
        } else {
            Outcome::Stalled
        }
    }

    fn motion(&self) -> Motion {
        true_motion(self.simulation.body())
    }

    /// Returns the motion as the robot measures it: speeds from odometry, and the pose with noise.
    fn measure(&mut self, motion: Motion) -> Motion {
        Motion {
            pose: self.noise.measure(&motion.pose),
            ..motion
        }
    }

    fn update_cell(&mut self, seen: &Motion) {
        let position_m = seen.pose.translation.vector.into();
        self.cell = cell_from_position(&self.maze, position_m, self.cell);
    }

    fn time_ns(&self) -> u64 {
        self.steps * STEP_NS
    }

    fn sample(&self) -> Sample {
        Sample {
            time_ns: self.time_ns(),
            robot_in_map: self.maze.pose_in_map(self.motion().pose),
            wheel_travel_m: self.wheels.travel_m,
        }
    }

    /// Starts a new path at the current pose.
    fn begin_trace(&mut self) {
        self.hits.clear();
        self.trace.clear();
        self.trace.push(self.sample());
    }
}

impl Arena for PhysicsArena {
    fn reset(&mut self, start: Cell) {
        self.simulation.set_state(&self.initial);
        let pose = eastward(self.maze.centre_in_grid(start));
        self.simulation.body_mut().set_position(pose, true);
        self.wheels = Wheels::default();
        self.cell = start;
        self.begin_trace();
        if let Some(mut sensing) = self.sensing.take() {
            self.look_round(&mut sensing);
            self.sensing = Some(sensing);
        }
    }

    fn act(&mut self, action: Action) -> Outcome {
        self.begin_trace();
        let Some(direction) = self.maze.direction(action) else {
            return Outcome::Stalled;
        };
        let home = self.cell;
        let wanted = self.maze.neighbour(home, direction).unwrap_or(home);
        if let Some(mut sensing) = self.sensing.take() {
            let outcome = self.act_with_sensors(&mut sensing, direction);
            self.sensing = Some(sensing);
            return outcome;
        }
        let seen = self.measure(self.motion());
        let middle = self.maze.centre_in_grid(home);
        let lengths_m = lengths_m(&self.maze, &self.params);
        let mut maneuver = Maneuver::new(middle, vector(direction), lengths_m, &seen);
        let arrived = self.perform(&mut maneuver);
        self.outcome(&maneuver, arrived, home, wanted)
    }

    fn view(&self) -> View<'_> {
        View {
            maze: &self.maze,
            cell: self.cell,
            trace: &self.trace,
            contacts: self.hits.contacts(),
            sensed: self.sensed(),
            executed: None,
            flipped: None,
            wheels_mps: None,
        }
    }

    fn set_clock(&mut self, time_ns: u64) {
        self.steps = time_ns / STEP_NS;
        self.begin_trace();
    }

    fn reseed(&mut self, seed: u64) {
        self.noise.stream = Stream::new(seed, StreamName::Physics);
        self.sensing = Sensing::new(&self.params, &self.maze, seed);
        self.steps = 0;
        self.reset(first_cell(&self.maze));
    }
}

/// Returns the blocks that make up the walls, or an error for worlds that cannot be simulated.
fn blocks(maze: &Maze) -> Result<Vec<Block>, PhysicsError> {
    let world = || maze.name().to_owned();
    if maze.wraps() {
        return Err(PhysicsError::JoinedEdges { world: world() });
    }
    if maze.moves() == Moves::Eight {
        return Err(PhysicsError::EightMoves { world: world() });
    }
    let extent_m = f64::from(maze.width().max(maze.height())) * maze.cell_size_m();
    if extent_m > MAX_EXTENT_M {
        return Err(PhysicsError::TooWide {
            world: world(),
            extent_m,
            limit_m: MAX_EXTENT_M,
        });
    }
    let blocks = maze.solid().blocks();
    if blocks.len() > MAX_BLOCKS {
        return Err(PhysicsError::TooManyWalls {
            world: world(),
            count: blocks.len(),
            limit: MAX_BLOCKS,
        });
    }
    Ok(blocks)
}

/// Returns the unit vector of one of the main directions.
fn vector(direction: Direction) -> Vector2<f64> {
    let (east, south) = direction.offset();
    Vector2::new(f64::from(east), f64::from(-south))
}

/// Returns the length of a move, and the distance from its end within which no wall stops it, in
/// metres. In a maze the robot that has left its cell can reach the next one. In a world from a map
/// something may be anywhere on the way.
fn lengths_m(maze: &Maze, params: &PhysicsParams) -> [f64; 2] {
    let size_m = maze.cell_size_m();
    let settled_m = match maze.is_from_map() {
        true => params.arrival_m,
        false => 0.5 * size_m,
    };
    [size_m, settled_m]
}
