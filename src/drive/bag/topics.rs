//! The topics of recorded drives, with their message types.

/// A topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum BagTopic {
    Tf,
    TfStatic,
    Odom,
    Pose,
    Scan,
    Imu,
    JointStates,
    InitialPose,
    Map,
    Clock,
    CmdVel,
    Decision,
    Fault,
}

/// The name of a message type, and its definition in MCAP's `ros2msg` form: followed by the
/// definitions it refers to.
pub(super) type Interface = (&'static str, &'static str);

/// A message type, from its name and the file of its definition.
macro_rules! interface {
    ($package:literal, $name:literal) => {
        (
            concat!($package, "/msg/", $name),
            include_str!(concat!($name, ".msg")),
        )
    };
}

/// The quality of service offered for a topic, as rosbag2 writes it up to metadata version 8, with
/// the numbers of rmw. The topic keeps the last `depth` messages and delivers them reliably. Late
/// subscribers get them only if the topic is transient-local (durability 1; 2 is volatile). There
/// are no deadlines.
macro_rules! qos {
    ($depth:literal, $durability:literal) => {
        concat!(
            "- history: 1\n  depth: ", $depth, "\n  reliability: 1\n  durability: ", $durability,
            "\n  deadline:\n    sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    \
             nsec: 854775807\n  liveliness: 1\n  liveliness_lease_duration:\n    sec: 9223372036\n    \
             nsec: 854775807\n  avoid_ros_namespace_conventions: false"
        )
    };
}

impl BagTopic {
    /// Returns the name of the topic.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tf => "/tf",
            Self::TfStatic => "/tf_static",
            Self::Odom => "/odom",
            Self::Pose => "/pose",
            Self::Scan => "/scan",
            Self::Imu => "/imu",
            Self::JointStates => "/joint_states",
            Self::InitialPose => "/initialpose",
            Self::Map => "/map",
            Self::Clock => "/clock",
            Self::CmdVel => "/cmd_vel",
            Self::Decision => "/decision",
            Self::Fault => "/fault",
        }
    }

    /// Returns the type of the topic's messages.
    pub fn interface(self) -> Interface {
        match self {
            Self::Tf | Self::TfStatic => interface!("tf2_msgs", "TFMessage"),
            Self::Odom => interface!("nav_msgs", "Odometry"),
            Self::Pose | Self::InitialPose => {
                interface!("geometry_msgs", "PoseWithCovarianceStamped")
            }
            Self::Scan => interface!("sensor_msgs", "LaserScan"),
            Self::Imu => interface!("sensor_msgs", "Imu"),
            Self::JointStates => interface!("sensor_msgs", "JointState"),
            Self::Map => interface!("nav_msgs", "OccupancyGrid"),
            Self::Clock => interface!("rosgraph_msgs", "Clock"),
            Self::CmdVel => interface!("geometry_msgs", "Twist"),
            Self::Decision | Self::Fault => interface!("std_msgs", "String"),
        }
    }

    /// Returns the quality of service of the topic.
    pub fn qos(self) -> &'static str {
        match self {
            Self::Map | Self::TfStatic => qos!(1, 1),
            _ => qos!(10, 2),
        }
    }
}
