//! ROS 2 messages, with the fields of the interface definitions.

use std::borrow::Cow;

use nalgebra::{Isometry2, Matrix3};
use serde::{Deserialize, Serialize};

use crate::world::Maze;

/// The frames of REP 105: the world, the origin of dead reckoning, and the robot.
pub const MAP: &str = "map";
pub const ODOM: &str = "odom";
pub const BASE: &str = "base_link";
/// The lidar's frame, at the centre of the robot.
#[cfg(feature = "ros2")]
pub const LASER: &str = "base_scan";
/// The robot's true pose, which the robot does not know.
#[cfg(feature = "ros2")]
pub const TRUE_BASE: &str = "base_link_true";
/// The value of an occupied cell in an occupancy grid, in percent.
const OCCUPIED: i8 = 100;

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Time {
    pub sec: i32,
    pub nanosec: u32,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Header {
    pub stamp: Time,
    pub frame_id: Cow<'static, str>,
}

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Vector3 {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Quaternion {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Pose {
    pub position: Vector3,
    pub orientation: Quaternion,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TransformStamped {
    pub header: Header,
    pub child_frame_id: Cow<'static, str>,
    pub transform: Pose,
}

/// `tf2_msgs/msg/TFMessage`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Transforms {
    pub transforms: Vec<TransformStamped>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PoseWithCovariance {
    pub pose: Pose,
    pub covariance: Covariance,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TwistWithCovariance {
    pub linear: Vector3,
    pub angular: Vector3,
    pub covariance: Covariance,
}

/// `nav_msgs/msg/Odometry`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Odometry {
    pub header: Header,
    pub child_frame_id: Cow<'static, str>,
    pub pose: PoseWithCovariance,
    pub twist: TwistWithCovariance,
}

/// `geometry_msgs/msg/PoseWithCovarianceStamped`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EstimatedPose {
    pub header: Header,
    pub pose: PoseWithCovariance,
}

/// `sensor_msgs/msg/LaserScan`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct LaserScan {
    pub header: Header,
    pub angle_min: f32,
    pub angle_max: f32,
    pub angle_increment: f32,
    pub time_increment: f32,
    pub scan_time: f32,
    pub range_min: f32,
    pub range_max: f32,
    pub ranges: Vec<f32>,
    pub intensities: Vec<f32>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MapMetaData {
    pub map_load_time: Time,
    pub resolution: f32,
    pub width: u32,
    pub height: u32,
    pub origin: Pose,
}

/// `nav_msgs/msg/OccupancyGrid`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct OccupancyGrid {
    pub header: Header,
    pub info: MapMetaData,
    pub data: Vec<i8>,
}

/// A 6x6 covariance over x, y, z and the rotations about them.
pub type Covariance = [[f64; 6]; 6];

/// The covariance of an unknown pose or speed.
pub const UNKNOWN: Covariance = [[0.0; 6]; 6];

/// Returns the covariance of x, y and heading. All other entries are 0 for a robot on a floor.
pub fn on_floor(of: &Matrix3<f64>) -> Covariance {
    const INDICES: [usize; 3] = [0, 1, 5];
    let mut all = UNKNOWN;
    for (row, &index) in INDICES.iter().enumerate() {
        for (column, &other) in INDICES.iter().enumerate() {
            all[index][other] = of[(row, column)];
        }
    }
    all
}

pub fn time(time_ns: u64) -> Time {
    let (seconds, rest) = (time_ns / 1_000_000_000, time_ns % 1_000_000_000);
    Time {
        // A trial never lasts 68 years.
        sec: i32::try_from(seconds).unwrap_or(i32::MAX),
        nanosec: rest as u32,
    }
}

pub fn header(time_ns: u64, frame_id: impl Into<Cow<'static, str>>) -> Header {
    Header {
        stamp: time(time_ns),
        frame_id: frame_id.into(),
    }
}

pub fn pose(pose: &Isometry2<f64>) -> Pose {
    let half_rad = pose.rotation.angle() / 2.0;
    let (sine, cosine) = libm::sincos(half_rad);
    Pose {
        position: Vector3 {
            x: pose.translation.x,
            y: pose.translation.y,
            z: 0.0,
        },
        orientation: Quaternion {
            x: 0.0,
            y: 0.0,
            z: sine,
            w: cosine,
        },
    }
}

impl Transforms {
    /// Creates the message from frames given as parent, child and the child's pose in the parent.
    pub fn new(time_ns: u64, frames: &[(&'static str, &'static str, Isometry2<f64>)]) -> Self {
        let frame =
            |(parent, child, at): &(&'static str, &'static str, Isometry2<f64>)| TransformStamped {
                header: header(time_ns, *parent),
                child_frame_id: (*child).into(),
                transform: pose(at),
            };
        Self {
            transforms: frames.iter().map(frame).collect(),
        }
    }
}

impl EstimatedPose {
    /// Creates the message from the estimated pose in the map frame and the covariance of x, y and
    /// heading.
    pub fn new(time_ns: u64, at: &Isometry2<f64>, covariance: &Matrix3<f64>) -> Self {
        Self {
            header: header(time_ns, MAP),
            pose: PoseWithCovariance {
                pose: pose(at),
                covariance: on_floor(covariance),
            },
        }
    }
}

impl OccupancyGrid {
    /// Creates the grid of the true walls, the lowest row first.
    pub fn new(time_ns: u64, maze: &Maze) -> Self {
        let solid = maze.solid();
        let [width, height] = solid.size();
        let pixels = (0..height).flat_map(|row| (0..width).map(move |col| (col, row)));
        // Both are at most 64 million.
        let data = pixels.map(|(col, row)| {
            if solid.is_solid(col as i32, row as i32) {
                OCCUPIED
            } else {
                0
            }
        });
        let corner = solid.corner_in_grid().copied();
        let grid = maze.grid_in_map();
        let place = |pose: Option<Isometry2<f64>>| pose.unwrap_or_else(Isometry2::identity);
        Self {
            header: header(time_ns, MAP),
            info: MapMetaData {
                map_load_time: Time::default(),
                resolution: solid.pixel_m() as f32,
                width: width as u32,
                height: height as u32,
                origin: pose(&(place(grid) * place(corner))),
            },
            data: data.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use byteorder::LittleEndian;
    use nalgebra::Vector2;

    /// Returns the bytes of a text in CDR: its length with the final zero, and padding.
    fn text(text: &str) -> Vec<u8> {
        let mut bytes = (text.len() as u32 + 1).to_le_bytes().to_vec();
        bytes.extend(text.as_bytes());
        bytes.push(0);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    }

    #[test]
    fn a_transform_has_the_bytes_of_its_interface_definition() {
        let odom_in_map = Isometry2::new(Vector2::new(1.5, 6.5), 0.0);
        let message = Transforms::new(2_000_000_003, &[(MAP, ODOM, odom_in_map)]);
        let bytes = cdr_encoding::to_vec::<_, LittleEndian>(&message).unwrap();
        let mut expected = Vec::new();
        for word in [1_u32, 2, 3] {
            expected.extend(word.to_le_bytes());
        }
        expected.extend(text("map"));
        expected.extend(text("odom"));
        // Numbers of eight bytes begin at a multiple of eight.
        expected.resize(expected.len().next_multiple_of(8), 0);
        for number in [1.5_f64, 6.5, 0.0, 0.0, 0.0, 0.0, 1.0] {
            expected.extend(number.to_le_bytes());
        }
        assert_eq!(bytes, expected);
    }
}
