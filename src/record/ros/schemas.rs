//! The interface definitions of the messages, in MCAP's `ros2msg` form: each definition is followed
//! by the definitions it refers to.

/// The name of a message type, and its definition.
pub type Interface = (&'static str, &'static str);

pub const TRANSFORMS: Interface = ("tf2_msgs/msg/TFMessage", include_str!("TFMessage.msg"));
pub const ODOMETRY: Interface = ("nav_msgs/msg/Odometry", include_str!("Odometry.msg"));
pub const SCAN: Interface = ("sensor_msgs/msg/LaserScan", include_str!("LaserScan.msg"));
pub const GRID: Interface = (
    "nav_msgs/msg/OccupancyGrid",
    include_str!("OccupancyGrid.msg"),
);
pub const POSE: Interface = (
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    include_str!("PoseWithCovarianceStamped.msg"),
);
pub const TWIST: Interface = ("geometry_msgs/msg/Twist", include_str!("Twist.msg"));
pub const IMU: Interface = ("sensor_msgs/msg/Imu", include_str!("Imu.msg"));
pub const CLOCK: Interface = ("rosgraph_msgs/msg/Clock", include_str!("Clock.msg"));
pub const TEXT: Interface = ("std_msgs/msg/String", include_str!("String.msg"));
