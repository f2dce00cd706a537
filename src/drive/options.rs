//! Options of the ROS 2 nodes that the feature `ros2` makes of the driver and the simulated robot.

/// Where a node lives.
#[derive(Debug, Clone)]
pub struct NodeOptions {
    /// The namespace of its topics, such as `/tb3`; `/` for none. `/clock` is in no namespace.
    pub namespace: String,
    /// The DDS domain, 0 to 232 (`ROS_DOMAIN_ID`).
    pub domain: u16,
}

/// How the driver runs.
#[derive(Debug, Clone)]
pub struct DriverOptions {
    /// The node.
    pub node: NodeOptions,
    /// Is the robot's time that of `/clock`?
    pub sim_time: bool,
    /// Does the robot want `TwistStamped` on `/cmd_vel`, and not `Twist`?
    pub stamped: bool,
    /// Decides, but publishes nothing on `/cmd_vel`.
    pub dry_run: bool,
}

/// How the simulated robot runs.
#[derive(Debug, Clone)]
pub struct SimulateOptions {
    /// The node.
    pub node: NodeOptions,
    /// How many times as fast as real time it runs.
    pub realtime_factor: f64,
    /// It ends after so many steps of 50 ms; `None` for no end of its own.
    pub steps: Option<u64>,
}
