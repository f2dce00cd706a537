//! Sensor readings: the fields of the robot's ROS 2 messages that the driver uses, in metres,
//! radians and seconds (REP 103).

use std::f64::consts::TAU;

use nalgebra::{Isometry2, Isometry3};

use crate::arena::{LidarParams, Speeds};
use crate::trial::ScanOrder;

/// A turn of the lidar (`sensor_msgs/msg/LaserScan`).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scan {
    /// The time of the first beam, in nanoseconds of the robot's clock.
    pub stamp_ns: u64,
    /// The frame of the lidar.
    pub frame: String,
    /// The direction of the first beam, counter-clockwise from the x axis of the lidar's frame.
    pub angle_min_rad: f64,
    /// The angle from one beam to the next.
    pub angle_increment_rad: f64,
    /// The time from one beam to the next; 0 if all beams are measured at once.
    pub time_increment_s: f64,
    /// The minimum measured range.
    pub range_min_m: f64,
    /// The maximum measured range.
    pub range_max_m: f64,
    /// The ranges. By REP 117, infinity means no return, minus infinity an object that is too near,
    /// and NaN no measurement. The driver of the LDS-01 sends 0 for no return.
    pub ranges_m: Vec<f64>,
}

impl Scan {
    /// Creates a scan of a whole turn. The first beam pointed ahead at `stamp_ns`.
    pub(crate) fn of_turn(stamp_ns: u64, lidar: &LidarParams, ranges_m: Vec<f64>) -> Self {
        let beams = f64::from(lidar.beams);
        Self {
            stamp_ns,
            frame: "base_scan".to_owned(),
            angle_min_rad: 0.0,
            angle_increment_rad: TAU / beams,
            time_increment_s: 1.0 / (lidar.rate_hz * beams),
            range_min_m: lidar.nearest_m,
            range_max_m: lidar.range_m,
            ranges_m,
        }
    }

    /// Returns the range of a beam, with [`range_min_m`](Self::range_min_m) for an object that is
    /// nearer; `None` if nothing came back or nothing was measured.
    pub fn measured_m(&self, number: usize) -> Option<f64> {
        let range_m = *self.ranges_m.get(number)?;
        // The driver of the LDS-01 sends 0 if nothing came back.
        if range_m == 0.0 || range_m.is_nan() || range_m > self.range_max_m {
            return None;
        }
        Some(range_m.max(self.range_min_m))
    }

    /// Returns the scan in chronological order.
    #[must_use]
    pub fn in_order(&self, order: ScanOrder) -> Self {
        match order {
            ScanOrder::Forward => self.clone(),
            ScanOrder::Reversed => Self {
                stamp_ns: self.stamp_ns.saturating_sub(self.turn_ns()),
                ..self.backward()
            },
            ScanOrder::ReversedFromFirst => self.backward(),
        }
    }

    /// Returns a scan in chronological order as a driver lists it.
    #[must_use]
    pub fn listed(&self, order: ScanOrder) -> Self {
        match order {
            ScanOrder::Forward => self.clone(),
            ScanOrder::Reversed => Self {
                stamp_ns: self.stamp_ns.saturating_add(self.turn_ns()),
                ..self.backward()
            },
            ScanOrder::ReversedFromFirst => self.backward(),
        }
    }

    /// Returns the number of beams after the first.
    fn after_first(&self) -> f64 {
        self.ranges_m.len().saturating_sub(1) as f64
    }

    /// Returns the time from the first beam to the last in nanoseconds.
    fn turn_ns(&self) -> u64 {
        (self.after_first() * self.time_increment_s.max(0.0) * 1e9).round() as u64
    }

    fn backward(&self) -> Self {
        Self {
            angle_min_rad: self.angle_min_rad + self.after_first() * self.angle_increment_rad,
            angle_increment_rad: -self.angle_increment_rad,
            ranges_m: self.ranges_m.iter().rev().copied().collect(),
            ..self.clone()
        }
    }
}

/// The pose of a frame in its parent (`geometry_msgs/msg/TransformStamped`).
#[derive(Debug, Clone, PartialEq)]
pub struct Transform {
    /// The name of the parent.
    pub parent: String,
    /// The name of the frame.
    pub child: String,
    /// The pose of the frame in its parent, in metres. Its rotation is not a number if the message has
    /// none.
    pub pose: Isometry3<f64>,
}

impl Transform {
    /// Returns true if all values are numbers.
    pub fn is_valid(&self) -> bool {
        let Isometry3 {
            rotation,
            translation,
        } = &self.pose;
        let mut numbers = rotation.coords.iter().chain(translation.vector.iter());
        numbers.all(|number| number.is_finite())
    }
}

/// The angles of joints (`sensor_msgs/msg/JointState`).
#[derive(Debug, Clone, PartialEq)]
pub struct JointAngles {
    /// The time, in nanoseconds of the robot's clock.
    pub stamp_ns: u64,
    /// The names of the joints.
    pub names: Vec<String>,
    /// The angle of each joint.
    pub angles_rad: Vec<f64>,
}

/// Dead reckoning (`nav_msgs/msg/Odometry`).
#[derive(Debug, Clone, PartialEq)]
pub struct Odometry {
    /// The time, in nanoseconds of the robot's clock.
    pub stamp_ns: u64,
    /// The frame of the pose, which starts where dead reckoning started.
    pub frame: String,
    /// The frame of the robot and of its speeds.
    pub child_frame: String,
    /// The pose of the robot in `frame`.
    pub pose: Isometry2<f64>,
    /// The speeds of the robot.
    pub speeds: Speeds,
}

/// A gyro reading (`sensor_msgs/msg/Imu`).
#[derive(Debug, Clone, PartialEq)]
pub struct Imu {
    /// The time, in nanoseconds of the robot's clock.
    pub stamp_ns: u64,
    /// Turn rate about the vertical axis, counter-clockwise.
    pub turn_radps: f64,
}

/// The state of the ROS network.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Network {
    /// The number of publishers on `/cmd_vel` other than this driver.
    pub other_publishers: usize,
    /// Topics with an incompatible publisher or subscriber: the name and the cause.
    pub incompatible: Vec<(String, String)>,
}

/// The readings that arrived since the last step, oldest first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Readings {
    /// Lidar turns.
    pub scans: Vec<Scan>,
    /// Dead reckoning.
    pub odometry: Vec<Odometry>,
    /// The gyro.
    pub imu: Vec<Imu>,
    /// The transforms of `/tf_static`.
    pub static_transforms: Vec<Transform>,
    /// The transforms of `/tf`.
    pub transforms: Vec<Transform>,
    /// The poses of `/initialpose`. Their child has no name.
    pub initial_poses: Vec<Transform>,
    /// The angles of the wheels, and of other joints.
    pub joints: Vec<JointAngles>,
    /// The last message on `/clock`, for a robot in simulated time; `None` if the robot uses the
    /// clock of this machine.
    pub clock_ns: Option<u64>,
    /// The state of the network.
    pub network: Network,
}

impl Readings {
    /// Puts earlier readings, with no odometry and no scans, before these.
    #[cfg(feature = "ros2")]
    pub(crate) fn follow(&mut self, mut earlier: Self) {
        earlier.imu.append(&mut self.imu);
        earlier
            .static_transforms
            .append(&mut self.static_transforms);
        earlier.transforms.append(&mut self.transforms);
        earlier.initial_poses.append(&mut self.initial_poses);
        earlier.joints.append(&mut self.joints);
        self.imu = earlier.imu;
        self.static_transforms = earlier.static_transforms;
        self.transforms = earlier.transforms;
        self.initial_poses = earlier.initial_poses;
        self.joints = earlier.joints;
    }
}
