//! Arguments of ROS 2 as options: `--ros-args -r scan:=/front/scan -p robot:=turtlebot3-burger`.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;

use serde::Deserialize;
use serde_json::Value;

/// The nodes of the program, with their subcommands.
const NODES: [(&str, &str); 2] = [("drive", "xcscr_driver"), ("simulate", "xcscr_robot")];

/// The parameters of a node in a file.
#[derive(Deserialize)]
struct Parameters {
    #[serde(rename = "ros__parameters")]
    all: BTreeMap<String, Value>,
}

/// Returns the arguments of a node with the options that its ROS 2 arguments mean. They begin after
/// `--ros-args` and end before `--`. Later parameters replace earlier ones. Other commands have none.
///
/// # Errors
/// Returns a message about an argument that is not supported, or a parameter that cannot be read.
pub fn expanded(all: Vec<OsString>) -> Result<Vec<OsString>, String> {
    let is_node = |(command, _): &&(&str, &str)| all.get(1).is_some_and(|word| word == command);
    let Some((_, node)) = NODES.iter().find(is_node) else {
        return Ok(all);
    };
    let (mut expanded, mut parameters) = (Vec::new(), BTreeMap::new());
    let mut words = all.into_iter();
    while let Some(word) = words.next() {
        if word != "--ros-args" {
            expanded.push(word);
            continue;
        }
        while let Some(flag) = words.next().filter(|flag| flag != "--") {
            let value = words.next().unwrap_or_default();
            let [flag, value] = [flag, value].map(|word| word.to_string_lossy().into_owned());
            match flag.as_str() {
                "-r" | "--remap" => expanded.extend(["--remap".into(), value.into()]),
                "-p" | "--param" => parameters.extend([parameter(&value)?]),
                "--params-file" => parameters.extend(file(&value, node)?),
                _ => return Err(format!("`{flag}` after `--ros-args` is not supported")),
            }
        }
    }
    let options = parameters
        .iter()
        .flat_map(|(name, value)| option(name, value));
    expanded.extend(options.map(OsString::from));
    Ok(expanded)
}

/// Returns the name and the value of a parameter such as `dry_run:=true`.
fn parameter(text: &str) -> Result<(String, Value), String> {
    let (name, value) = text
        .split_once(":=")
        .ok_or_else(|| format!("`{text}` has no `:=`"))?;
    let value = match value {
        "true" => Value::Bool(true),
        "false" => Value::Bool(false),
        text => Value::from(text),
    };
    Ok((name.to_owned(), value))
}

/// Returns the parameters of a node in a YAML file.
fn file(path: &str, node: &str) -> Result<Vec<(String, Value)>, String> {
    let fault =
        |cause: &dyn std::fmt::Display| format!("cannot read the parameters in {path}: {cause}");
    let text = fs::read_to_string(path).map_err(|cause| fault(&cause))?;
    let nodes: BTreeMap<String, Parameters> =
        serde_saphyr::from_str(&text).map_err(|cause| fault(&cause))?;
    let is_own =
        |name: &str| matches!(name.rsplit('/').next(), Some(last) if last == "**" || last == node);
    let own = nodes.into_iter().filter(|(name, _)| is_own(name));
    Ok(own.flat_map(|(_, parameters)| parameters.all).collect())
}

/// Returns the option of a parameter: `true` is the option alone, `false` is no option, and the
/// elements of a list are separated by commas.
fn option(name: &str, value: &Value) -> Vec<String> {
    let name = match name {
        "use_sim_time" => "--sim-time".to_owned(),
        name => format!("--{}", name.replace('_', "-")),
    };
    let word = |value: &Value| {
        value
            .as_str()
            .map_or_else(|| value.to_string(), str::to_owned)
    };
    match value {
        Value::Bool(true) => vec![name],
        Value::Bool(false) => Vec::new(),
        Value::Array(all) => vec![name, all.iter().map(word).collect::<Vec<_>>().join(",")],
        value => vec![name, word(value)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> Vec<OsString> {
        line.split(' ').map(OsString::from).collect()
    }

    #[test]
    fn arguments_of_ros_become_options() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("drive.yaml");
        let text = "/**:\n  ros__parameters:\n    robot: mine.toml\n    start: [1.5, -2, 0.0]\nother:\n  \
                    ros__parameters:\n    force: true\n";
        fs::write(&file, text).unwrap();
        let line = format!(
            "xcscr drive run --ros-args -r scan:=/front/scan -p use_sim_time:=true -p robot:=none --params-file {} -- --ros2",
            file.display()
        );
        let options = "xcscr drive run --remap scan:=/front/scan --ros2 --robot mine.toml --start 1.5,-2,0.0 --sim-time";
        assert_eq!(expanded(words(&line)), Ok(words(options)));
        let others = words("xcscr train maze4 --ros-args -r a:=b");
        assert_eq!(expanded(others.clone()), Ok(others), "control");
        for wrong in [
            "-p robot",
            "--log-level debug",
            "--params-file missing.yaml",
            "-p",
        ] {
            let line = format!("xcscr drive run --ros-args {wrong}");
            assert!(expanded(words(&line)).is_err(), "{wrong}");
        }
    }
}
