//! Layouts for Foxglove and Lichtblick, fitted to a maze.

use serde_json::{Value, json};

use super::json::json_tree;
use crate::record::topics::caption;
use crate::world::Maze;

const EPISODE: &str = include_str!("../../assets/foxglove-layout.json");
const RUN: &str = include_str!("../../assets/foxglove-layout-run.json");

/// The layout for the files of single episodes, as compact JSON.
pub fn of_episode(maze: &Maze) -> String {
    fitted(EPISODE, maze)
}

/// The layout for `run.mcap`, as compact JSON.
pub fn of_run(maze: &Maze) -> String {
    fitted(RUN, maze)
}

/// Looks at the maze's middle from where all of it is seen, and has a curve for each action.
fn fitted(layout: &str, maze: &Maze) -> String {
    let mut layout: Value = serde_json::from_str(layout).expect("the layouts in assets are JSON");
    for (id, panel) in layout["configById"].as_object_mut().into_iter().flatten() {
        if id.starts_with("3D!") {
            aim(&mut panel["cameraState"], maze);
        } else if id == "Plot!worth" {
            // Of a whole run, only what the start of each episode is worth.
            let of_starts = panel["xAxisVal"] == "custom";
            let steps = if of_starts { "/step{step==1}" } else { "/step" };
            panel["paths"] = worth_paths(maze, steps);
        }
    }
    layout.to_string()
}

/// Puts the camera where a panel a little wider than high shows the whole maze and its caption.
fn aim(camera: &mut Value, maze: &Maze) {
    let unit = maze.cell_size_m();
    let (wide, high) = (
        f64::from(maze.width()) * unit,
        f64::from(maze.height()) * unit + caption::height_m(maze),
    );
    // Half the field of view is 22.5 degrees; tilted by 35 degrees, the near edge comes closer
    // by 0.29 of the height and looks 0.82 as high.
    let distance = (1.1 * wide + 0.29 * high).max(1.28 * high);
    camera["distance"] = json!((distance * 1000.0).round() / 1000.0);
    camera["targetOffset"] = json!([wide / 2.0, high / 2.0, 0.0]);
    camera["near"] = json!(0.02 * unit);
    camera["far"] = json!((20.0 * distance).ceil());
}

/// A path for the worth of each action in these messages.
fn worth_paths(maze: &Maze, steps: &str) -> Value {
    const COLORS: [&str; 8] = [
        "#1f77e0", "#ff8c1a", "#17a673", "#c23ee8", "#e0322f", "#7a5c3e", "#12b5c9", "#8a8f99",
    ];
    let paths = maze.moves().directions().iter().zip(COLORS).enumerate();
    paths
        .map(|(action, (direction, color))| {
            json!({
                "value": format!("{steps}.worth[{action}]"),
                "label": direction.name(),
                "color": color,
                "enabled": true,
                "lineSize": 1.5,
                "timestampMethod": "receiveTime",
            })
        })
        .collect()
}

/// Something in a recording that a layout shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MessagePath {
    /// The topic.
    pub topic: String,
    /// The field of its messages, if it is not all of them.
    pub field: Option<String>,
}

impl std::fmt::Display for MessagePath {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.topic)?;
        self.field
            .iter()
            .try_for_each(|field| write!(f, ".{field}"))
    }
}

/// Everything that the panels of a layout show; nothing for what is no layout.
pub fn paths(layout: &[u8]) -> Vec<MessagePath> {
    let layout = json_tree(layout).unwrap_or_default();
    let panels = layout["configById"].as_object();
    let mut texts: Vec<&str> = Vec::new();
    for (_, panel) in panels.into_iter().flatten() {
        let topics = panel["topics"].as_object().into_iter().flatten();
        texts.extend(topics.map(|(topic, _)| topic.as_str()));
        let curves = panel["paths"].as_array().into_iter().flatten();
        let curves = curves
            .chain([&panel["xAxisPath"]])
            .map(|curve| &curve["value"]);
        let single = ["path", "topicPath", "topicToRender"].map(|key| &panel[key]);
        texts.extend(curves.chain(single).filter_map(Value::as_str));
    }
    texts.into_iter().map(message_path).collect()
}

/// `/step.worth[0]` is the field `worth` of `/step`, and so is `/step{step==1}.worth[0]`.
fn message_path(text: &str) -> MessagePath {
    let (topic, rest) = text.split_once('.').unwrap_or((text, ""));
    let topic = topic.split('{').next().unwrap_or(topic);
    let field = rest.split(['.', '[', '{', ':']).next();
    MessagePath {
        topic: topic.to_owned(),
        field: field.filter(|name| !name.is_empty()).map(str::to_owned),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_has_a_topic_and_perhaps_a_field() {
        let show = |text| message_path(text).to_string();
        assert_eq!(show("/step.worth[0]"), "/step.worth");
        assert_eq!(show("/step{step==1}.worth[0]"), "/step.worth");
        assert_eq!(show("/curve.steps[:]"), "/curve.steps");
        assert_eq!(show("/step"), "/step");
    }
}
