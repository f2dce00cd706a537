//! `xcscr simulate`: the physics arena as a ROS 2 robot.

use std::path::PathBuf;

use xcscr::ErrorKind;
use xcscr::drive::{SimulateOptions, SimulatedRobot};
use xcscr::trial::{RobotProfile, ScanOrder, Settings};
use xcscr::world::Maze;

use super::choices::{self, SettingsArgs};
use super::failure::Failure;
use super::node::{self, NodeArgs};

/// Simulated steps per second.
const STEPS_PER_S: f64 = 20.0;

/// Arguments of `simulate`.
#[derive(Debug, clap::Args)]
pub struct SimulateArgs {
    /// The maze: a world file, or the name of a bundled world.
    world: PathBuf,
    /// Run as a ROS 2 node (needs a build with `--features ros2`).
    #[arg(long, required = true)]
    ros2: bool,
    /// Speed as a multiple of real time.
    #[arg(long, value_name = "F", default_value = "1", value_parser = factor)]
    realtime_factor: f64,
    /// Start pose in the map frame: x and y in metres, heading in radians [default: the start
    /// cell].
    #[arg(long, value_name = "X,Y,YAW", value_parser = node::pose, allow_hyphen_values = true)]
    start: Option<[f64; 3]>,
    /// Expect TwistStamped on cmd_vel instead of Twist.
    #[arg(long)]
    stamped: bool,
    /// Seed of the wheel and sensor noise.
    #[arg(long, value_name = "S", default_value = "1", value_parser = choices::seed)]
    seed: u64,
    /// Stop after this many simulated seconds.
    #[arg(long, value_name = "N")]
    seconds: Option<u32>,
    #[command(flatten)]
    settings: SettingsArgs,
    #[command(flatten)]
    node: NodeArgs,
}

fn factor(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(factor) if (0.01..=100.0).contains(&factor) => Ok(factor),
        _ => Err("must be from 0.01 to 100".to_owned()),
    }
}

impl SimulateArgs {
    /// Returns the order in which the driver of the robot's lidar lists the beams.
    fn scan_order(&self) -> Result<ScanOrder, Failure> {
        let profile = self.settings.robot.as_deref().map(RobotProfile::load);
        Ok(profile
            .transpose()?
            .map_or(ScanOrder::Forward, |it| it.scan_order()))
    }
}

/// Simulates until Ctrl-C.
pub fn run(args: &SimulateArgs) -> Result<(), Failure> {
    let maze = choices::world(&args.world)?;
    let settings = args.settings.resolve(&Settings::default())?.settings;
    let robot = SimulatedRobot::new(maze.clone(), &settings.physics, args.seed, args.start);
    let mut robot = robot.map_err(|error| Failure::new(ErrorKind::BadData, error.to_string()))?;
    let options = SimulateOptions {
        node: args.node.options()?,
        stamped: args.stamped,
        scan_order: args.scan_order()?,
        realtime_factor: args.realtime_factor,
        steps: args
            .seconds
            .map(|seconds| (f64::from(seconds) * STEPS_PER_S) as u64),
    };
    simulate(&maze, &mut robot, &options)
}

#[cfg(feature = "ros2")]
fn simulate(
    maze: &Maze,
    robot: &mut SimulatedRobot,
    options: &SimulateOptions,
) -> Result<(), Failure> {
    use super::interrupt::Interrupt;
    use super::terminal::say;

    let interrupt = Interrupt::notice()?;
    let (name, node) = (maze.name(), &options.node);
    say(&format!(
        "Simulating a robot in {name}: domain {}, namespace {}. Commands: cmd_vel. Stop: Ctrl-C.",
        node.domain, node.namespace
    ));
    xcscr::ros2::simulate(maze, robot, options, &|| interrupt.came())?;
    Ok(())
}

#[cfg(not(feature = "ros2"))]
fn simulate(_: &Maze, _: &mut SimulatedRobot, _: &SimulateOptions) -> Result<(), Failure> {
    Err(node::missing())
}
