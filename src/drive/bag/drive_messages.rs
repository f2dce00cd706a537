//! Messages of driven robots, in addition to those of recordings, and their conversion to the
//! driver's readings.

use std::borrow::Cow;

use nalgebra::{Complex, Isometry2, Translation2, UnitComplex};
use serde::{Deserialize, Serialize};

use super::messages::{
    BASE, EstimatedPose, Header, LaserScan, Odometry, Pose, PoseWithCovariance, Quaternion, Time,
    TwistWithCovariance, UNKNOWN, Vector3, header, pose, time,
};
use crate::arena::Speeds;
use crate::drive::{self, Belief};

/// The largest deviation of the norm of a quaternion from 1.
const ROUNDED: f64 = 0.1;

/// `geometry_msgs/msg/Twist`.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Twist {
    pub linear: Vector3,
    pub angular: Vector3,
}

/// `geometry_msgs/msg/TwistStamped`.
#[cfg(feature = "ros2")]
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TwistStamped {
    pub header: Header,
    pub twist: Twist,
}

/// `sensor_msgs/msg/Imu`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Imu {
    pub header: Header,
    pub orientation: Quaternion,
    pub orientation_covariance: [f64; 9],
    pub angular_velocity: Vector3,
    pub angular_velocity_covariance: [f64; 9],
    pub linear_acceleration: Vector3,
    pub linear_acceleration_covariance: [f64; 9],
}

/// `sensor_msgs/msg/JointState`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct JointState {
    pub header: Header,
    pub name: Vec<String>,
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    pub effort: Vec<f64>,
}

/// `rosgraph_msgs/msg/Clock`.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Clock {
    pub clock: Time,
}

/// `std_msgs/msg/String`.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Text {
    pub data: Cow<'static, str>,
}

impl Time {
    /// Returns the nanoseconds since the start of the clock; 0 for earlier times.
    pub fn nanoseconds(self) -> u64 {
        u64::try_from(self.sec).unwrap_or(0) * 1_000_000_000 + u64::from(self.nanosec)
    }
}

impl Clock {
    /// Creates a message from a time in nanoseconds.
    pub fn new(time_ns: u64) -> Self {
        Self {
            clock: time(time_ns),
        }
    }
}

impl Text {
    /// Creates a message from a text.
    pub fn new(text: impl Into<Cow<'static, str>>) -> Self {
        Self { data: text.into() }
    }
}

impl Pose {
    /// Returns the pose on the floor. Its numbers may be invalid, like those of the message. The heading is
    /// not a number if the orientation is no rotation.
    fn on_floor(&self) -> Isometry2<f64> {
        let Quaternion { x, y, z, w } = self.orientation;
        let heading = if self.orientation.is_rotation() {
            Complex::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (w * z + x * y))
        } else {
            Complex::new(f64::NAN, f64::NAN)
        };
        Isometry2::from_parts(
            Translation2::new(self.position.x, self.position.y),
            UnitComplex::new_normalize(heading),
        )
    }
}

impl Quaternion {
    /// Returns true for a rotation. Drivers round, but a quaternion of zeros is none.
    pub(super) fn is_rotation(self) -> bool {
        let Self { x, y, z, w } = self;
        let norm = (x * x + y * y + z * z + w * w).sqrt();
        (norm - 1.0).abs() < ROUNDED
    }
}

impl From<&JointState> for drive::JointAngles {
    fn from(message: &JointState) -> Self {
        Self {
            stamp_ns: message.header.stamp.nanoseconds(),
            names: message.name.clone(),
            angles_rad: message.position.clone(),
        }
    }
}

impl From<&drive::JointAngles> for JointState {
    fn from(joints: &drive::JointAngles) -> Self {
        Self {
            header: header(joints.stamp_ns, ""),
            name: joints.names.clone(),
            position: joints.angles_rad.clone(),
            velocity: Vec::new(),
            effort: Vec::new(),
        }
    }
}

impl From<Speeds> for Twist {
    fn from(speeds: Speeds) -> Self {
        let along = |x: f64, z: f64| Vector3 { x, y: 0.0, z };
        Self {
            linear: along(speeds.forward_mps, 0.0),
            angular: along(0.0, speeds.turn_radps),
        }
    }
}

#[cfg(feature = "ros2")]
impl TwistStamped {
    /// Creates a message from speeds in the frame of the robot.
    pub fn new(time_ns: u64, speeds: Speeds) -> Self {
        Self {
            header: header(time_ns, BASE),
            twist: speeds.into(),
        }
    }
}

impl From<Twist> for Speeds {
    fn from(twist: Twist) -> Self {
        Self {
            forward_mps: twist.linear.x,
            turn_radps: twist.angular.z,
        }
    }
}

impl From<&Odometry> for drive::Odometry {
    fn from(message: &Odometry) -> Self {
        Self {
            stamp_ns: message.header.stamp.nanoseconds(),
            frame: message.header.frame_id.to_string(),
            child_frame: message.child_frame_id.to_string(),
            pose: message.pose.pose.on_floor(),
            speeds: Speeds {
                forward_mps: message.twist.linear.x,
                turn_radps: message.twist.angular.z,
            },
        }
    }
}

impl From<&drive::Odometry> for Odometry {
    fn from(odometry: &drive::Odometry) -> Self {
        let Twist { linear, angular } = odometry.speeds.into();
        Self {
            header: header(odometry.stamp_ns, odometry.frame.clone()),
            child_frame_id: odometry.child_frame.clone().into(),
            pose: PoseWithCovariance {
                pose: pose(&odometry.pose),
                covariance: UNKNOWN,
            },
            twist: TwistWithCovariance {
                linear,
                angular,
                covariance: UNKNOWN,
            },
        }
    }
}

impl From<&Imu> for drive::Imu {
    fn from(message: &Imu) -> Self {
        Self {
            stamp_ns: message.header.stamp.nanoseconds(),
            turn_radps: message.angular_velocity.z,
        }
    }
}

impl From<&drive::Imu> for Imu {
    fn from(imu: &drive::Imu) -> Self {
        // By the definition of the message, -1 means that there is no orientation estimate.
        let mut unknown = [0.0; 9];
        unknown[0] = -1.0;
        Self {
            header: header(imu.stamp_ns, BASE),
            orientation: pose(&Isometry2::identity()).orientation,
            orientation_covariance: unknown,
            angular_velocity: Vector3 {
                x: 0.0,
                y: 0.0,
                z: imu.turn_radps,
            },
            angular_velocity_covariance: [0.0; 9],
            linear_acceleration: Vector3::default(),
            linear_acceleration_covariance: unknown,
        }
    }
}

impl From<&LaserScan> for drive::Scan {
    fn from(message: &LaserScan) -> Self {
        Self {
            stamp_ns: message.header.stamp.nanoseconds(),
            frame: message.header.frame_id.to_string(),
            angle_min_rad: message.angle_min.into(),
            angle_increment_rad: message.angle_increment.into(),
            time_increment_s: message.time_increment.into(),
            range_min_m: message.range_min.into(),
            range_max_m: message.range_max.into(),
            ranges_m: message.ranges.iter().map(|&range| range.into()).collect(),
        }
    }
}

impl From<&drive::Scan> for LaserScan {
    fn from(scan: &drive::Scan) -> Self {
        let last = scan.ranges_m.len().saturating_sub(1) as f64;
        Self {
            header: header(scan.stamp_ns, scan.frame.clone()),
            angle_min: scan.angle_min_rad as f32,
            angle_max: (scan.angle_min_rad + last * scan.angle_increment_rad) as f32,
            angle_increment: scan.angle_increment_rad as f32,
            time_increment: scan.time_increment_s as f32,
            scan_time: (scan.time_increment_s * (last + 1.0)) as f32,
            range_min: scan.range_min_m as f32,
            range_max: scan.range_max_m as f32,
            ranges: scan.ranges_m.iter().map(|&range| range as f32).collect(),
            intensities: Vec::new(),
        }
    }
}

impl From<&Belief> for EstimatedPose {
    fn from(belief: &Belief) -> Self {
        Self::new(belief.stamp_ns, &belief.robot_in_map, &belief.covariance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use byteorder::LittleEndian;
    use nalgebra::Vector2;
    use serde::de::DeserializeOwned;

    /// Encodes and decodes a message.
    fn sent<M: Serialize + DeserializeOwned>(message: &M) -> M {
        let bytes = cdr_encoding::to_vec::<_, LittleEndian>(message).unwrap();
        cdr_encoding::from_bytes::<M, LittleEndian>(&bytes)
            .unwrap()
            .0
    }

    #[test]
    fn messages_survive_encoding_and_decoding() {
        let odometry = drive::Odometry {
            stamp_ns: 1_234_567_890_123,
            frame: "odom".to_owned(),
            child_frame: "base_link".to_owned(),
            pose: Isometry2::new(Vector2::new(1.5, -2.25), 2.5),
            speeds: Speeds {
                forward_mps: 0.5,
                turn_radps: -1.5,
            },
        };
        let arrived = drive::Odometry::from(&sent(&Odometry::from(&odometry)));
        let off = arrived.pose.inverse() * odometry.pose;
        assert!(off.translation.vector.norm() < 1e-12 && off.rotation.angle().abs() < 1e-12);
        let arrived = drive::Odometry {
            pose: odometry.pose,
            ..arrived
        };
        assert_eq!(arrived, odometry);
        let scan = drive::Scan {
            stamp_ns: 5,
            frame: "base_scan".to_owned(),
            angle_min_rad: -1.0,
            angle_increment_rad: 0.5,
            time_increment_s: 0.125,
            range_min_m: 0.25,
            range_max_m: 8.0,
            ranges_m: vec![1.5, f64::INFINITY, f64::NEG_INFINITY],
        };
        assert_eq!(drive::Scan::from(&sent(&LaserScan::from(&scan))), scan);
        let imu = drive::Imu {
            stamp_ns: 7_000_000_001,
            turn_radps: 0.75,
        };
        assert_eq!(drive::Imu::from(&sent(&Imu::from(&imu))), imu);
        let twist: Twist = odometry.speeds.into();
        assert_eq!(Speeds::from(sent(&twist)), odometry.speeds);
        let words = "cell 1,1: east".to_owned();
        assert_eq!(sent(&Text::new(words.clone())).data, words);
        let clock = sent(&Clock::new(3_000_000_004));
        assert_eq!(clock.clock.nanoseconds(), 3_000_000_004);
    }
}
