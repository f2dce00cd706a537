//! Layouts for Foxglove and Lichtblick: the JSON files of this folder, fitted to a maze.
//!
//! `episode.json` is the layout for the files of single episodes, and `run.json` that for `run.mcap`. A layout that is
//! exported from a viewer can replace them. Cameras and the curves of actions depend on the maze, and are set here.

use serde_json::{Value, json};

use crate::topics::{caption, policy, size_m};
use xcscr_robot::world::Maze;

const EPISODE: &str = include_str!("episode.json");
const RUN: &str = include_str!("run.json");

/// The distance of the camera that follows the robot, in cells.
const FOLLOW: f64 = 9.0;
/// The factor by which the first camera is moved away if there is a second one.
const BESIDE: f64 = 1.25;
/// The colours of the values of the actions.
const ACTIONS: [&str; 8] = [
    "#4e98e2", "#f5774d", "#5cd6a9", "#a395e2", "#f7df71", "#61cbff", "#cad660", "#8a8f99",
];

/// Returns the layout for the files of single episodes, as compact JSON. In a large maze, a second view
/// follows the robot.
pub fn of_episode(maze: &Maze) -> String {
    let mut layout = fitted(EPISODE, "/rule.values", maze);
    if policy::is_large(maze) {
        let panels = &mut layout["configById"];
        panels["3D!follow"] = following(&mut panels["3D!main"], maze);
        layout["layout"]["first"]["first"] = json!({
            "direction": "row", "splitPercentage": 58, "first": "3D!main", "second": "3D!follow"
        });
    }
    layout.to_string()
}

/// Returns the layout for `run.mcap`, as compact JSON.
pub fn of_run(maze: &Maze) -> String {
    fitted(RUN, "/episode.start_values", maze).to_string()
}

/// Returns a layout whose main view shows the whole maze, with a curve for each of these values of the actions.
fn fitted(layout: &str, values: &str, maze: &Maze) -> Value {
    let mut layout: Value = serde_json::from_str(layout).expect("the layouts are JSON");
    let panels = &mut layout["configById"];
    let main = &mut panels["3D!main"];
    aim(&mut main["cameraState"], maze);
    if policy::is_large(maze) {
        let shown = &mut main["topics"]["/values"];
        shown["colorField"] = json!("nearness");
        shown["gradient"] = json!(["#e6ac0073", "#45106b73"]);
    }
    if let Some(paths) = panels["Plot!values"]["paths"].as_array_mut() {
        let directions = maze.moves().directions().iter();
        let actions = directions.zip(ACTIONS).enumerate();
        paths.extend(actions.map(|(action, (direction, color))| {
            json!({
                "value": format!("{values}[{action}]"),
                "label": direction.name(),
                "color": color,
                "enabled": true,
                "lineSize": 1.5,
                "timestampMethod": "receiveTime",
            })
        }));
    }
    layout
}

/// Returns a panel with a camera that follows the robot, and moves the camera of the other panel away:
/// there is less room next to a second one.
fn following(main: &mut Value, maze: &Maze) -> Value {
    let mut panel = main.clone();
    for title in ["foxglovePanelTitle", "lichtblickPanelTitle"] {
        panel[title] = json!("Around the robot");
    }
    panel["followTf"] = json!("base_link_true");
    panel["followMode"] = json!("follow-position");
    panel["cameraState"]["distance"] = json!(FOLLOW * maze.cell_size_m());
    panel["cameraState"]["targetOffset"] = json!([0, 0, 0]);
    // The size of its letters fits the view of the whole maze.
    panel["topics"]["/scene/rule"]["visible"] = json!(false);
    let whole = &mut main["cameraState"]["distance"];
    *whole = json!(whole.as_f64().map(|distance| (BESIDE * distance).ceil()));
    panel
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
