//! The simulated robot as a ROS 2 node.

use std::thread::sleep;
use std::time::{Duration, Instant};

use nalgebra::Isometry2;
use ros2_client::{Publisher, Subscription};
use serde::Serialize;

use super::covariance::DeadReckoning;
use super::link::{Link, STAMPED, TWIST, best_effort, drain, reliable, transient_local};
use crate::Error;
use crate::arena::{PhysicsParams, Speeds};
use crate::drive::drive_messages::{Clock, Imu, Twist, TwistStamped};
use crate::drive::messages::{
    BASE, LASER, LaserScan, MAP, ODOM, OccupancyGrid, Odometry, TRUE_BASE, Transforms,
};
use crate::drive::{self, SimulateOptions, SimulatedReadings, SimulatedRobot};
use crate::trial::ScanOrder;
use crate::world::Maze;

/// The simulated time of a step.
const STEP: Duration = Duration::from_millis(50);
/// The poll interval for commands and for `stop`.
const TICK: Duration = Duration::from_millis(2);

/// The subscription to commands.
enum Commands {
    Plain(Subscription<Twist>),
    Stamped(Subscription<TwistStamped>),
}

impl Commands {
    fn open(link: &mut Link, stamped: bool) -> Result<Self, Error> {
        let qos = best_effort();
        Ok(if stamped {
            Self::Stamped(link.subscription("cmd_vel", STAMPED, &qos)?)
        } else {
            Self::Plain(link.subscription("cmd_vel", TWIST, &qos)?)
        })
    }

    /// Returns the newest of the commands that arrived since the last call.
    fn newest(&self) -> Option<Speeds> {
        match self {
            Self::Plain(all) => Some(drain(all).pop()?.0.into()),
            Self::Stamped(all) => Some(drain(all).pop()?.0.twist.into()),
        }
    }
}

struct RobotNode {
    /// Keeps the node alive, because publishers end with their node.
    _link: Link,
    clock: Publisher<Clock>,
    scan: Publisher<LaserScan>,
    odom: Publisher<Odometry>,
    truth: Publisher<Odometry>,
    imu: Publisher<Imu>,
    tf: Publisher<Transforms>,
    tf_static: Publisher<Transforms>,
    map: Publisher<OccupancyGrid>,
    scan_order: ScanOrder,
    reckoning: DeadReckoning,
    cmd_vel: Commands,
}

impl RobotNode {
    fn open(options: &SimulateOptions) -> Result<Self, Error> {
        let mut link = Link::open("xcscr_robot", &options.node)?;
        let odometry = ["nav_msgs", "Odometry"];
        let transforms = ["tf2_msgs", "TFMessage"];
        Ok(Self {
            clock: link.publisher("clock", ["rosgraph_msgs", "Clock"], &reliable())?,
            scan: link.publisher("scan", ["sensor_msgs", "LaserScan"], &reliable())?,
            odom: link.publisher("odom", odometry, &reliable())?,
            truth: link.publisher("ground_truth/odom", odometry, &reliable())?,
            imu: link.publisher("imu", ["sensor_msgs", "Imu"], &reliable())?,
            tf: link.publisher("tf", transforms, &reliable())?,
            tf_static: link.publisher("tf_static", transforms, &transient_local())?,
            map: link.publisher("map", ["nav_msgs", "OccupancyGrid"], &transient_local())?,
            scan_order: options.scan_order,
            reckoning: DeadReckoning::default(),
            cmd_vel: Commands::open(&mut link, options.stamped)?,
            _link: link,
        })
    }

    /// Publishes the static transforms and the map.
    fn publish_static(&self, maze: &Maze) {
        let mount = Transforms::new(0, &[(BASE, LASER, Isometry2::identity())]);
        publish(&self.tf_static, mount);
        publish(&self.map, OccupancyGrid::new(0, maze));
    }

    /// Publishes the readings of a step, and the true pose before and after it.
    fn publish_readings(
        &mut self,
        readings: &SimulatedReadings,
        [before, after]: &[Isometry2<f64>; 2],
        physics: &PhysicsParams,
    ) {
        let SimulatedReadings {
            time_ns,
            odometry,
            imu,
            scan,
        } = readings;
        publish(&self.clock, Clock::new(*time_ns));
        let mut message = Odometry::from(odometry);
        [message.pose.covariance, message.twist.covariance] = self.reckoning.add(odometry, physics);
        publish(&self.odom, message);
        let frames = [(ODOM, BASE, odometry.pose)];
        publish(&self.tf, Transforms::new(*time_ns, &frames));
        let moved = before.inverse() * after;
        let truth = drive::Odometry {
            stamp_ns: *time_ns,
            frame: MAP.to_owned(),
            child_frame: TRUE_BASE.to_owned(),
            pose: *after,
            speeds: Speeds {
                forward_mps: moved.translation.x / STEP.as_secs_f64(),
                turn_radps: moved.rotation.angle() / STEP.as_secs_f64(),
            },
        };
        publish(&self.truth, Odometry::from(&truth));
        if let Some(imu) = imu {
            let mut message = Imu::from(imu);
            let gyro = &physics.gyro;
            // The last entry is that of the rotation about z.
            message.angular_velocity_covariance[8] =
                (physics.noise * gyro.noise_radps.hypot(gyro.bias_radps)).powi(2);
            publish(&self.imu, message);
        }
        if let Some(scan) = scan {
            publish(&self.scan, LaserScan::from(&scan.listed(self.scan_order)));
        }
    }
}

/// Publishes a message. A full queue drops it, as on a radio link.
fn publish<M: Serialize>(publisher: &Publisher<M>, message: M) {
    let _ = publisher.publish(message);
}

/// Runs a simulated robot as a node until `stop` returns true. Returns the number of steps.
///
/// Publishes `/clock`, `/scan`, `/odom`, `/imu`, `/tf`, `/tf_static`, `/map` and
/// `/ground_truth/odom`, and follows the commands on `/cmd_vel`. A command is in effect for half a
/// second of simulated time.
///
/// # Errors
/// Returns an error if the node or a topic cannot be created.
pub fn simulate(
    maze: &Maze,
    robot: &mut SimulatedRobot,
    options: &SimulateOptions,
    stop: &dyn Fn() -> bool,
) -> Result<u64, Error> {
    let mut node = RobotNode::open(options)?;
    node.publish_static(maze);
    let period = STEP.div_f64(options.realtime_factor);
    let mut due = Instant::now();
    let mut steps = 0;
    while !stop() && options.steps.is_none_or(|most| steps < most) {
        if let Some(command) = node.cmd_vel.newest() {
            robot.command(command);
        }
        let left = due.saturating_duration_since(Instant::now());
        if !left.is_zero() {
            sleep(left.min(TICK));
            continue;
        }
        let before = robot.true_pose();
        let readings = robot.step();
        node.publish_readings(&readings, &[before, robot.true_pose()], robot.physics());
        steps += 1;
        // After a pause of this machine, continue from the current time.
        due = (due + period).max(Instant::now() - period);
    }
    Ok(steps)
}
