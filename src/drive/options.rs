//! Options of the ROS 2 nodes (feature `ros2`) for the driver and the simulated robot.

use super::given::PoseSource;

/// The namespace and domain of a node.
#[derive(Debug, Clone)]
pub struct NodeOptions {
    /// The namespace of the node's topics, such as `/tb3`; `/` for none. `/clock` has no namespace.
    pub namespace: String,
    /// The DDS domain, 0 to 232 (`ROS_DOMAIN_ID`).
    pub domain: u16,
    /// Announce the node on this machine only (`ROS_LOCALHOST_ONLY`).
    pub localhost_only: bool,
}

/// Options of the driver node.
#[derive(Debug, Clone)]
pub struct DriverOptions {
    /// The node.
    pub node: NodeOptions,
    /// Take the robot's time from `/clock`.
    pub sim_time: bool,
    /// Publish `TwistStamped` on `/cmd_vel` instead of `Twist`.
    pub stamped: bool,
    /// Decide, but publish nothing on `/cmd_vel`.
    pub dry_run: bool,
    /// Where the pose of the robot comes from.
    pub source: PoseSource,
    /// Read the angles of the wheels.
    pub reads_joints: bool,
}

/// Options of the simulated robot node.
#[derive(Debug, Clone)]
pub struct SimulateOptions {
    /// The node.
    pub node: NodeOptions,
    /// Expect `TwistStamped` on `/cmd_vel` instead of `Twist`.
    pub stamped: bool,
    /// The speed as a multiple of real time.
    pub realtime_factor: f64,
    /// The number of steps of 50 ms after which the node ends; `None` for no limit.
    pub steps: Option<u64>,
}
