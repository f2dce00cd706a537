//! The setup of a drive, checked before anything moves.

use nalgebra::{Isometry2, Vector2};
use serde_json::Value;
use xcscr_sensing::PUT_DOWN;

use super::checks::Frames;
use super::given::PoseSource;
use super::wheels::Wheels;
use crate::agent::Knowledge;
use crate::arena::{ArenaKind, Localisation, PhysicsParams, check_fit};
use crate::sensor::Sensor;
use crate::trial::{Plan, RobotProfile, ScanOrder};
use crate::world::{Maze, Moves};
use crate::{Error, ErrorKind};

/// A policy, the robot it drives, and the robot's pose.
#[derive(Debug, Clone)]
pub struct DriveSetup {
    pub(super) maze: Maze,
    pub(super) sensor: Sensor,
    pub(super) physics: PhysicsParams,
    pub(super) knowledge: Knowledge,
    pub(super) step_threshold: u32,
    pub(super) seed: u64,
    pub(super) start_in_grid: Isometry2<f64>,
    pub(super) laser_in_base: Option<Isometry2<f64>>,
    pub(super) frames: Frames,
    pub(super) scan_order: ScanOrder,
    pub(super) source: PoseSource,
    pub(super) start_tolerance: [f64; 2],
    pub(super) wheels: Option<Wheels>,
}

/// Differences between a drive and the run whose policy it uses.
#[derive(Debug, Clone, Default)]
pub struct DriveOptions {
    /// The robot; `None` for the robot of the run.
    pub robot: Option<RobotProfile>,
    /// The maze; `None` for the maze of the run.
    pub world: Option<Maze>,
    /// The start pose in the map frame: x and y in metres, and the heading in radians. `None` for
    /// the middle of the start cell, heading along the rows of the maze.
    pub start: Option<[f64; 3]>,
    /// The pose of the lidar on the robot: x and y in metres, and the heading in radians. `None` takes
    /// the pose, and the name of the frame, from the static transforms.
    pub laser: Option<[f64; 3]>,
    /// The expected frames of messages.
    pub frames: Frames,
    /// The order in which scans list their beams; `None` for that of the profile in `robot`.
    pub scan_order: Option<ScanOrder>,
    /// Where the pose of the robot comes from.
    pub source: PoseSource,
    /// The deviations of the start pose: in metres, and in radians. `None` for a centimetre and 0.6
    /// degrees.
    pub start_tolerance: Option<[f64; 2]>,
    /// The joints of the wheels; `None` to compute the ways of the wheels from odometry.
    pub wheels: Option<Wheels>,
}

impl DriveSetup {
    /// Checks that a policy can drive a robot.
    ///
    /// # Errors
    /// Returns an error if the policy is for another robot or cell size, if no robot can sense the
    /// percept, or if the start is in a wall.
    pub fn new(plan: &Plan, knowledge: &Knowledge, options: DriveOptions) -> Result<Self, Error> {
        let config = &plan.config;
        let physics = robot(plan, options.robot.as_ref())?;
        let profile_order = options.robot.as_ref().map(RobotProfile::scan_order);
        let trained = &plan.maze;
        let maze = options.world.unwrap_or_else(|| trained.clone());
        let maze = maze.for_robot(physics.needed_m()).unwrap_or(maze);
        let world = maze.name();
        if maze.cell_size_m() != trained.cell_size_m() {
            return Err(refusal(format!(
                "the policy was trained in cells of {} m, but {world} has cells of {} m; train it in {world}",
                trained.cell_size_m(),
                maze.cell_size_m()
            )));
        }
        if !config.sensor.is_sensed() {
            return Err(refusal(format!(
                "a robot cannot sense the percept `{}`, which is read from the maze; train with `--sensor lidar` or \
                 `lidar-position`",
                config.sensor.name()
            )));
        }
        if config.settings.sensor.history > 0 {
            return Err(refusal(
                "the policy needs the earlier steps (`sensor.history`), which a drive does not keep; train without it",
            ));
        }
        if !physics.lidar.fitted {
            return Err(refusal("the robot has no lidar (`physics.lidar.fitted`)"));
        }
        if maze.moves() == Moves::Eight || maze.wraps() {
            return Err(refusal(format!(
                "{world} has eight moves or joined edges, which a robot cannot drive"
            )));
        }
        check_fit(&maze, &physics)?;
        knowledge.check(config.sensor, &maze)?;
        Ok(Self {
            start_in_grid: start(&maze, options.start)?,
            laser_in_base: options.laser.map(pose),
            frames: options.frames,
            scan_order: options.scan_order.or(profile_order).unwrap_or_default(),
            source: options.source,
            start_tolerance: tolerance(&maze, options.start_tolerance)?,
            wheels: options.wheels.map(checked).transpose()?,
            sensor: config.sensor,
            step_threshold: config.settings.reward.step_threshold,
            seed: config.seed,
            knowledge: knowledge.clone(),
            // A real robot is told its pose by nobody.
            physics: PhysicsParams {
                localisation: Localisation::Estimated,
                ..physics
            },
            maze,
        })
    }

    /// Returns the maze of the drive.
    pub fn maze(&self) -> &Maze {
        &self.maze
    }

    /// Returns the settings of the robot.
    pub fn physics(&self) -> &PhysicsParams {
        &self.physics
    }
}

fn refusal(message: impl Into<String>) -> Error {
    ErrorKind::BadData.error(message)
}

/// Returns the robot of a drive, which must equal the robot of the run.
fn robot(plan: &Plan, profile: Option<&RobotProfile>) -> Result<PhysicsParams, Error> {
    let settings = &plan.config.settings;
    let Some(profile) = profile else {
        return match plan.config.arena {
            ArenaKind::Physics => Ok(settings.physics.clone()),
            ArenaKind::Grid => Err(refusal(
                "the policy was trained on the grid; name the robot with `--robot`",
            )),
        };
    };
    let found = profile.settings_over(settings)?.physics;
    if plan.config.arena == ArenaKind::Grid {
        return Ok(found);
    }
    let all = [&settings.physics, &found].map(|params| serde_json::to_value(params).ok());
    let [Some(trained), Some(own)] = all else {
        return Ok(found);
    };
    let robot = profile.name();
    match difference("physics", &trained, &own) {
        None => Ok(found),
        Some((setting, trained, found)) => Err(refusal(format!(
            "the policy was trained with a different robot, not with {robot}: `{setting}` is {trained} there and {found} \
             here; train it with `--robot {robot}`"
        ))),
    }
}

/// Returns the first setting that differs, with both values.
fn difference(key: &str, one: &Value, other: &Value) -> Option<(String, String, String)> {
    match (one, other) {
        (Value::Object(one), Value::Object(other)) => one.iter().find_map(|(name, value)| {
            difference(&format!("{key}.{name}"), value, other.get(name)?)
        }),
        _ if one == other => None,
        _ => Some((key.to_owned(), one.to_string(), other.to_string())),
    }
}

fn pose([x, y, yaw]: [f64; 3]) -> Isometry2<f64> {
    Isometry2::new(Vector2::new(x, y), yaw)
}

/// Converts a pose in the map frame to the grid frame.
pub(super) fn in_grid(maze: &Maze, in_map: [f64; 3]) -> Isometry2<f64> {
    let grid = maze.grid_in_map().unwrap_or_else(Isometry2::identity);
    grid.inverse() * pose(in_map)
}

/// Returns the deviations of the start pose.
fn tolerance(maze: &Maze, given: Option<[f64; 2]>) -> Result<[f64; 2], Error> {
    let [off_m, off_rad] = given.unwrap_or(PUT_DOWN);
    let most_m = maze.cell_size_m() / 4.0;
    if (0.001..=most_m).contains(&off_m) && (0.001..=0.5).contains(&off_rad) {
        Ok([off_m, off_rad])
    } else {
        Err(refusal(format!(
            "the start tolerance is {off_m} m and {off_rad} rad, but must be from 0.001 to {most_m} m, a quarter of a \
             cell, and from 0.001 to 0.5 rad"
        )))
    }
}

fn checked(wheels: Wheels) -> Result<Wheels, Error> {
    if (0.005..=0.5).contains(&wheels.radius_m) {
        Ok(wheels)
    } else {
        Err(refusal(format!(
            "the radius of the wheels is {} m, but must be from 0.005 to 0.5 m",
            wheels.radius_m
        )))
    }
}

/// Returns the start pose in the grid frame.
pub(super) fn start(maze: &Maze, given: Option<[f64; 3]>) -> Result<Isometry2<f64>, Error> {
    let Some(given) = given else {
        let no_start = "the world has no fixed start cell; pass `--start x,y,yaw` in the map frame";
        let cell = maze.start().ok_or_else(|| refusal(no_start))?;
        let middle = maze.centre_in_grid(cell);
        return Ok(Isometry2::translation(middle.x, middle.y));
    };
    let in_grid = in_grid(maze, given);
    let cell = maze.cell_in_grid(in_grid.translation.vector.into());
    let is_free = cell.is_some_and(|cell| !maze.is_wall(cell) && !maze.is_goal(cell));
    if is_free && given.iter().all(|number| number.is_finite()) {
        Ok(in_grid)
    } else {
        Err(refusal(format!(
            "the start {given:?} is not in a free cell of the maze, or in a goal; pass `--start x,y,yaw` in the \
             map frame"
        )))
    }
}
