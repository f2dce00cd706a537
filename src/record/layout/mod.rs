//! Layouts for Foxglove and Lichtblick, from the JSON files in this folder, fitted to a maze.

use serde_json::{Value, json};

use crate::record::topics::{caption, policy, size_m};
use crate::world::Maze;

const EPISODE: &str = include_str!("episode.json");
const RUN: &str = include_str!("run.json");

/// In mazes with more columns or rows than this, single arrows are visible only to the camera that
/// follows the robot. From afar, the colours of the floor and the greedy path show the same.
const FINE: u16 = 24;
/// Mazes with more columns or rows than this have a second camera, which follows the robot.
const NEAR: u16 = 12;
/// The distance of the second camera, in cells.
const FOLLOW: f64 = 9.0;
/// The factor by which the first camera is moved away if there is a second one.
const BESIDE: f64 = 1.25;

/// Returns the layout for the files of single episodes, as compact JSON.
pub fn of_episode(maze: &Maze) -> String {
    fitted(EPISODE, maze)
}

/// Returns the layout for `run.mcap`, as compact JSON.
pub fn of_run(maze: &Maze) -> String {
    fitted(RUN, maze)
}

/// Aims the cameras so that the whole maze is visible, and adds a curve for each action.
fn fitted(layout: &str, maze: &Maze) -> String {
    let mut layout: Value =
        serde_json::from_str(layout).expect("the layouts beside this file are JSON");
    for (id, panel) in layout["configById"].as_object_mut().into_iter().flatten() {
        if id.starts_with("3D!") {
            aim(&mut panel["cameraState"], maze);
        } else if id == "Plot!values" {
            panel["paths"] = with_each_action(&panel["paths"], maze);
        }
    }
    if policy::is_large(maze) {
        let values = &mut layout["configById"]["3D!main"]["topics"]["/values"];
        values["colorField"] = json!("nearness");
        values["gradient"] = json!(["#e6ac0073", "#45106b73"]);
    }
    if maze.width().max(maze.height()) > FINE {
        layout["configById"]["3D!main"]["topics"]["/scene/policy"]["visible"] = json!(false);
    }
    let follows = !layout["configById"]["StateTransitions!steps"].is_null();
    if follows && maze.width().max(maze.height()) > NEAR {
        follow(&mut layout, maze);
    }
    layout.to_string()
}

/// Adds a camera that follows the robot, next to the one that shows the whole maze.
fn follow(layout: &mut Value, maze: &Maze) {
    let mut panel = layout["configById"]["3D!main"].clone();
    panel["followTf"] = json!("base_link_true");
    panel["followMode"] = json!("follow-position");
    panel["cameraState"]["distance"] = json!(FOLLOW * maze.cell_size_m());
    panel["cameraState"]["targetOffset"] = json!([0, 0, 0]);
    // The size of its letters fits the view of the whole maze.
    panel["topics"]["/scene/rule"]["visible"] = json!(false);
    panel["topics"]["/scene/policy"]["visible"] = json!(true);
    name(&mut panel, "Around the robot");
    layout["configById"]["3D!follow"] = panel;
    // There is less room for the whole maze next to the second panel.
    let whole = &mut layout["configById"]["3D!main"]["cameraState"]["distance"];
    *whole = json!(whole.as_f64().map(|distance| (BESIDE * distance).ceil()));
    let left = &mut layout["layout"]["first"]["first"];
    *left = json!({
        "direction": "row",
        "splitPercentage": 58,
        "first": left.take(),
        "second": "3D!follow",
    });
}

/// Sets the title of a panel.
fn name(panel: &mut Value, title: &str) {
    for key in ["foxglovePanelTitle", "lichtblickPanelTitle"] {
        panel[key] = json!(title);
    }
}

/// Places the camera so that a panel slightly wider than high shows the whole maze and its caption.
fn aim(camera: &mut Value, maze: &Maze) {
    let unit = maze.cell_size_m();
    let [wide, rows_m] = size_m(maze);
    let high = rows_m + caption::height_m(maze);
    // Half the field of view is 22.5 degrees, and the maze fills nine tenths of it: K is the
    // tangent. The camera is tilted by 30 degrees, with cosine C and sine S. It looks at the point
    // from which the southern edge and the caption appear equally far.
    const K: f64 = 0.375;
    const C: f64 = 0.866;
    const S: f64 = 0.5;
    let distance = high * (C * C - K * K * S * S) / (2.0 * C * K);
    // A panel is at least 1.3 times as wide as high.
    let distance = distance.max(wide / (2.0 * 1.3 * K) + high * S * C / 2.0);
    let middle = K * distance / (C + K * S);
    camera["distance"] = json!((distance * 1000.0).round() / 1000.0);
    camera["targetOffset"] = json!([wide / 2.0, (middle * 1000.0).round() / 1000.0, 0.0]);
    camera["near"] = json!(0.02 * unit);
    camera["far"] = json!((20.0 * distance).ceil());
}

/// Returns the paths, with one for each action of the maze in place of the paths of actions.
fn with_each_action(paths: &Value, maze: &Maze) -> Value {
    let paths = paths.as_array().into_iter().flatten();
    let field = |path: &Value| {
        path["value"]
            .as_str()?
            .split_once('[')
            .map(|(it, _)| it.to_owned())
    };
    let (of_actions, mut all): (Vec<Value>, Vec<Value>) =
        paths.cloned().partition(|path| field(path).is_some());
    if let Some(values) = of_actions.first().and_then(field) {
        all.extend(value_paths(maze, &values));
    }
    all.into()
}

/// Returns a path for the value of each action.
fn value_paths(maze: &Maze, values: &str) -> Vec<Value> {
    const COLORS: [&str; 8] = [
        "#4e98e2", "#f5774d", "#5cd6a9", "#a395e2", "#f7df71", "#61cbff", "#cad660", "#8a8f99",
    ];
    let paths = maze.moves().directions().iter().zip(COLORS).enumerate();
    paths
        .map(|(action, (direction, color))| {
            json!({
                "value": format!("{values}[{action}]"),
                "label": direction.name(),
                "color": color,
                "enabled": true,
                "lineSize": 1.5,
                "timestampMethod": "receiveTime",
            })
        })
        .collect()
}
