//! Arguments of the commands that are ROS 2 nodes.

use xcscr::drive::NodeOptions;

/// The namespace and domain of a node.
#[derive(Debug, clap::Args)]
pub struct NodeArgs {
    /// Namespace of the topics, such as /tb3. /clock has no namespace.
    #[arg(long, value_name = "N", default_value = "/")]
    namespace: String,
    /// DDS domain [default: ROS_DOMAIN_ID, or 0].
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u16).range(0..=232))]
    domain: Option<u16>,
}

impl NodeArgs {
    /// Returns the options of the node.
    pub fn options(&self) -> NodeOptions {
        let of_environment = || std::env::var("ROS_DOMAIN_ID").ok()?.parse().ok();
        let namespace = self.namespace.trim_matches('/');
        NodeOptions {
            namespace: format!("/{namespace}"),
            domain: self.domain.or_else(of_environment).unwrap_or(0),
        }
    }
}

/// Parses a pose: x and y in metres and the heading in radians, separated by commas.
pub fn pose(text: &str) -> Result<[f64; 3], String> {
    let fault = || "a pose is x,y,yaw: two lengths in metres and an angle in radians".to_owned();
    super::choices::numbers(text).ok_or_else(fault)
}

/// Returns the failure of a build without ROS 2.
#[cfg(not(feature = "ros2"))]
pub fn missing() -> super::failure::Failure {
    let message = "this build has no ROS 2: build it with `cargo build --features ros2`";
    super::failure::Failure::new(xcscr::ErrorKind::Usage, message)
}
