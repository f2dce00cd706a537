//! The interface definitions of the messages, in MCAP's `ros2msg` form: each definition is followed
//! by the definitions it refers to.

/// A message type and its definition.
#[derive(Debug, Clone, Copy)]
pub struct Interface {
    pub name: &'static str,
    pub definition: &'static str,
}

pub const TRANSFORMS: Interface = Interface {
    name: "tf2_msgs/msg/TFMessage",
    definition: include_str!("TFMessage.msg"),
};
pub const ODOMETRY: Interface = Interface {
    name: "nav_msgs/msg/Odometry",
    definition: include_str!("Odometry.msg"),
};
pub const SCAN: Interface = Interface {
    name: "sensor_msgs/msg/LaserScan",
    definition: include_str!("LaserScan.msg"),
};
pub const GRID: Interface = Interface {
    name: "nav_msgs/msg/OccupancyGrid",
    definition: include_str!("OccupancyGrid.msg"),
};
pub const POSE: Interface = Interface {
    name: "geometry_msgs/msg/PoseWithCovarianceStamped",
    definition: include_str!("PoseWithCovarianceStamped.msg"),
};
pub const TWIST: Interface = Interface {
    name: "geometry_msgs/msg/Twist",
    definition: include_str!("Twist.msg"),
};
pub const IMU: Interface = Interface {
    name: "sensor_msgs/msg/Imu",
    definition: include_str!("Imu.msg"),
};
pub const CLOCK: Interface = Interface {
    name: "rosgraph_msgs/msg/Clock",
    definition: include_str!("Clock.msg"),
};
pub const TEXT: Interface = Interface {
    name: "std_msgs/msg/String",
    definition: include_str!("String.msg"),
};
