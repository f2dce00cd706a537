//! Arguments of the commands that are ROS 2 nodes.

use xcscr::ErrorKind;
use xcscr::drive::{NodeOptions, Wheels};

use super::failure::Failure;

/// The namespace and domain of a node.
#[derive(Debug, clap::Args)]
pub struct NodeArgs {
    /// Namespace of the topics, such as /tb3. /clock has no namespace.
    #[arg(long, value_name = "N", default_value = "/")]
    namespace: String,
    /// DDS domain [default: ROS_DOMAIN_ID, or 0].
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u16).range(0..=232))]
    domain: Option<u16>,
    /// Another name for a topic, also of the node (`__node`) and its namespace (`__ns`); `--ros-args -r`
    /// means the same.
    #[arg(long, value_name = "FROM:=TO", value_parser = remap)]
    remap: Vec<(String, String)>,
}

impl NodeArgs {
    /// Returns the options of the node, by the arguments and the environment variables of ROS 2.
    pub fn options(&self) -> Result<NodeOptions, Failure> {
        let variable = |name: &str| std::env::var(name).ok();
        let mut remaps = self.remap.clone();
        let special = remaps.extract_if(.., |(from, _)| from == "__ns").last();
        let namespace = special.map_or(self.namespace.clone(), |(_, to)| to);
        let namespace = namespace.trim_matches('/');
        Ok(NodeOptions {
            namespace: format!("/{namespace}"),
            domain: match self.domain {
                Some(domain) => domain,
                None => domain(&variable)?,
            },
            localhost_only: is_local(&variable)?,
            remaps,
        })
    }
}

/// The value of an environment variable.
type Variable<'a> = &'a dyn Fn(&str) -> Option<String>;

fn refusal(name: &str, value: &str, must: &str) -> Failure {
    let message = format!("{name} is `{value}`, but {must}");
    Failure::new(ErrorKind::Usage, message)
}

/// Returns the domain of `ROS_DOMAIN_ID`.
fn domain(variable: Variable<'_>) -> Result<u16, Failure> {
    let name = "ROS_DOMAIN_ID";
    let Some(value) = variable(name).filter(|value| !value.is_empty()) else {
        return Ok(0);
    };
    let domain = value.parse().ok().filter(|domain| *domain <= 232);
    domain.ok_or_else(|| refusal(name, &value, "must be a number from 0 to 232"))
}

/// Returns true if the environment allows nodes of this machine only.
fn is_local(variable: Variable<'_>) -> Result<bool, Failure> {
    let name = "ROS_DISCOVERY_SERVER";
    if let Some(value) = variable(name).filter(|value| !value.is_empty()) {
        let must = "xcscr has no discovery server: unset it in all nodes";
        return Err(refusal(name, &value, must));
    }
    let name = "ROS_LOCALHOST_ONLY";
    let is_only = match variable(name).as_deref() {
        None | Some("" | "0") => false,
        Some("1") => true,
        Some(value) => return Err(refusal(name, value, "must be 0 or 1")),
    };
    let name = "ROS_AUTOMATIC_DISCOVERY_RANGE";
    match variable(name).as_deref() {
        None | Some("" | "SUBNET" | "SYSTEM_DEFAULT") => Ok(is_only),
        Some("LOCALHOST") => Ok(true),
        Some(value) => Err(refusal(name, value, "must be SUBNET or LOCALHOST")),
    }
}

/// Parses another name for a topic.
fn remap(text: &str) -> Result<(String, String), String> {
    let parts = text
        .split_once(":=")
        .filter(|(from, to)| !from.is_empty() && !to.is_empty());
    let (from, to) = parts.ok_or("must be two names with `:=` between them")?;
    Ok((from.to_owned(), to.to_owned()))
}

/// Parses a pose: x and y in metres and the heading in radians, separated by commas.
pub fn pose(text: &str) -> Result<[f64; 3], String> {
    let fault = || "a pose is x,y,yaw: two lengths in metres and an angle in radians".to_owned();
    super::choices::numbers(text).ok_or_else(fault)
}

/// Parses numbers that are separated by commas.
pub fn numbers<const COUNT: usize>(text: &str) -> Result<[f64; COUNT], String> {
    super::choices::numbers(text).ok_or_else(|| format!("must be {COUNT} numbers with commas"))
}

/// Parses the joints of the wheels.
pub fn wheels(text: &str) -> Result<Wheels, String> {
    let fault = || "must be the names of two joints and a length in metres".to_owned();
    let parts: Vec<&str> = text.split(',').collect();
    let [left, right, radius] = parts[..] else {
        return Err(fault());
    };
    Ok(Wheels {
        joints: [left, right].map(str::to_owned),
        radius_m: radius.parse().map_err(|_| fault())?,
    })
}

/// Returns the failure of a build without ROS 2.
#[cfg(not(feature = "ros2"))]
pub fn missing() -> Failure {
    let message =
        "this build has no ROS 2: install it with `cargo install --path . --features ros2`";
    Failure::new(ErrorKind::Usage, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the domain and whether the node is local, for one variable.
    fn options(name: &str, value: &str) -> Option<(u16, bool)> {
        let variable = |asked: &str| (asked == name).then(|| value.to_owned());
        Some((domain(&variable).ok()?, is_local(&variable).ok()?))
    }

    #[test]
    fn environment_variables_of_ros_are_obeyed_or_refused() {
        let domain = "ROS_DOMAIN_ID";
        assert_eq!(options(domain, "42"), Some((42, false)));
        for value in ["233", "-1", "1.0", "domain", "99999999999"] {
            assert_eq!(options(domain, value), None, "{value}");
        }
        let only = "ROS_LOCALHOST_ONLY";
        assert_eq!(options(only, "1"), Some((0, true)));
        assert_eq!(options(only, "0"), Some((0, false)), "control");
        assert_eq!(options(only, "yes"), None);
        let range = "ROS_AUTOMATIC_DISCOVERY_RANGE";
        assert_eq!(options(range, "LOCALHOST"), Some((0, true)));
        assert_eq!(options(range, "SUBNET"), Some((0, false)), "control");
        assert_eq!(options(range, "OFF"), None);
        let server = "ROS_DISCOVERY_SERVER";
        assert_eq!(options(server, "10.0.0.1:11811"), None);
        assert_eq!(options(server, ""), Some((0, false)), "control");
    }
}
