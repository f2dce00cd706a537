//! Options of the ROS 2 nodes (feature `ros2`) for the driver and the simulated robot.

use super::given::PoseSource;
use crate::trial::ScanOrder;

/// The namespace and domain of a node.
#[derive(Debug, Clone)]
pub struct NodeOptions {
    /// The namespace of the node's topics, such as `/tb3`; `/` for none. `/clock` has no namespace.
    pub namespace: String,
    /// The DDS domain, 0 to 232 (`ROS_DOMAIN_ID`).
    pub domain: u16,
    /// Announce the node on this machine only (`ROS_LOCALHOST_ONLY`).
    pub localhost_only: bool,
    /// Other names of topics: from and to. A name without a leading slash is in the namespace.
    pub remaps: Vec<(String, String)>,
}

impl NodeOptions {
    /// Returns the full name of a topic, after remapping.
    pub fn topic(&self, name: &str) -> String {
        let full = |name: &str| match (name, self.namespace.trim_matches('/')) {
            (name, _) if name.starts_with('/') => name.to_owned(),
            ("clock", _) | (_, "") => format!("/{name}"),
            (_, namespace) => format!("/{namespace}/{name}"),
        };
        let own = full(name);
        let remap = self.remaps.iter().find(|(from, _)| full(from) == own);
        remap.map_or(own, |(_, to)| full(to))
    }
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
    /// The order in which scans list their beams.
    pub scan_order: ScanOrder,
    /// The speed as a multiple of real time.
    pub realtime_factor: f64,
    /// The number of steps of 50 ms after which the node ends; `None` for no limit.
    pub steps: Option<u64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_in_the_namespace_unless_they_are_remapped() {
        let mut options = NodeOptions {
            namespace: "/tb3".to_owned(),
            domain: 0,
            localhost_only: false,
            remaps: Vec::new(),
        };
        let names =
            |options: &NodeOptions| ["scan", "odom", "clock"].map(|name| options.topic(name));
        assert_eq!(names(&options), ["/tb3/scan", "/tb3/odom", "/clock"]);
        let remaps = [("scan", "/front/scan"), ("/tb3/odom", "odometry/filtered")];
        options.remaps = remaps
            .map(|(from, to)| (from.to_owned(), to.to_owned()))
            .to_vec();
        assert_eq!(
            names(&options),
            ["/front/scan", "/tb3/odometry/filtered", "/clock"]
        );
        options.namespace = "/".to_owned();
        assert_eq!(names(&options), ["/front/scan", "/odom", "/clock"]);
    }
}
