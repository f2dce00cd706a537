//! The simulated robot as a node.

use std::thread::sleep;
use std::time::{Duration, Instant};

use nalgebra::Isometry2;
use ros2_client::{Publisher, Subscription};
use serde::Serialize;

use super::error::Ros2Error;
use super::link::{Link, drain, heard, lasting, told};
use crate::drive::{NodeOptions, SimulateOptions, SimulatedReadings, SimulatedRobot};
use crate::record::drive_messages::{Clock, Imu, Twist};
use crate::record::messages::{
    BASE, LASER, LaserScan, MAP, ODOM, OccupancyGrid, Odometry, TRUE_BASE, Transforms,
};
use crate::world::Maze;

/// Simulated time of a step.
const STEP: Duration = Duration::from_millis(50);
/// How often one looks for commands and for the end.
const TICK: Duration = Duration::from_millis(2);

struct RobotNode {
    /// Publishers end with their node.
    _link: Link,
    clock: Publisher<Clock>,
    scan: Publisher<LaserScan>,
    odom: Publisher<Odometry>,
    truth: Publisher<Odometry>,
    imu: Publisher<Imu>,
    tf: Publisher<Transforms>,
    tf_static: Publisher<Transforms>,
    map: Publisher<OccupancyGrid>,
    cmd_vel: Subscription<Twist>,
}

impl RobotNode {
    fn open(options: &NodeOptions) -> Result<Self, Ros2Error> {
        let mut link = Link::open("xcscr_robot", options)?;
        let odometry = ["nav_msgs", "Odometry"];
        let transforms = ["tf2_msgs", "TFMessage"];
        Ok(Self {
            clock: link.publisher("clock", ["rosgraph_msgs", "Clock"], &told())?,
            scan: link.publisher("scan", ["sensor_msgs", "LaserScan"], &told())?,
            odom: link.publisher("odom", odometry, &told())?,
            truth: link.publisher("ground_truth/odom", odometry, &told())?,
            imu: link.publisher("imu", ["sensor_msgs", "Imu"], &told())?,
            tf: link.publisher("tf", transforms, &told())?,
            tf_static: link.publisher("tf_static", transforms, &lasting())?,
            map: link.publisher("map", ["nav_msgs", "OccupancyGrid"], &lasting())?,
            cmd_vel: link.subscription("cmd_vel", ["geometry_msgs", "Twist"], &heard())?,
            _link: link,
        })
    }

    /// What never changes.
    fn introduce(&self, maze: &Maze) {
        let mount = Transforms::new(0, &[(BASE, LASER, Isometry2::identity())]);
        publish(&self.tf_static, mount);
        publish(&self.map, OccupancyGrid::new(0, maze));
    }

    fn tell(&self, readings: &SimulatedReadings, truth: &Isometry2<f64>) {
        let SimulatedReadings {
            time_ns,
            odometry,
            imu,
            scan,
        } = readings;
        publish(&self.clock, Clock::new(*time_ns));
        publish(&self.odom, Odometry::from(odometry));
        let frames = [(ODOM, BASE, odometry.pose)];
        publish(&self.tf, Transforms::new(*time_ns, &frames));
        let still = (&Isometry2::identity(), 0.0);
        let truth = Odometry::new(*time_ns, [MAP, TRUE_BASE], truth, still);
        publish(&self.truth, truth);
        if let Some(imu) = imu {
            publish(&self.imu, Imu::from(imu));
        }
        if let Some(scan) = scan {
            publish(&self.scan, LaserScan::from(scan));
        }
    }
}

/// Publishes a message. One that a full queue does not take is lost, as on a radio link.
fn publish<M: Serialize>(publisher: &Publisher<M>, message: M) {
    let _ = publisher.publish(message);
}

/// Runs a simulated robot as a node until `stop` says so.
///
/// It publishes `/clock`, `/scan`, `/odom`, `/imu`, `/tf`, `/tf_static`, `/map` and `/ground_truth/odom`, and drives as `/cmd_vel`
/// says. A command holds for half a second of simulated time.
///
/// # Errors
/// When the node or a topic cannot be made.
pub fn simulate(
    maze: &Maze,
    robot: &mut SimulatedRobot,
    options: &SimulateOptions,
    stop: &dyn Fn() -> bool,
) -> Result<u64, Ros2Error> {
    let node = RobotNode::open(&options.node)?;
    node.introduce(maze);
    let period = STEP.div_f64(options.realtime_factor);
    let mut due = Instant::now();
    let mut steps = 0;
    while !stop() && options.steps.is_none_or(|most| steps < most) {
        if let Some((command, _)) = drain(&node.cmd_vel).pop() {
            robot.command(command.into());
        }
        let left = due.saturating_duration_since(Instant::now());
        if !left.is_zero() {
            sleep(left.min(TICK));
            continue;
        }
        let readings = robot.step();
        node.tell(&readings, &robot.true_pose());
        steps += 1;
        // After a pause of this machine, time goes on from now.
        due = (due + period).max(Instant::now() - period);
    }
    Ok(steps)
}
