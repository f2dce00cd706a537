//! Layouts for Foxglove and Lichtblick, fitted to a maze.

mod episode;
mod panels;
mod run;

pub use episode::of_episode;
pub use run::of_run;

use serde_json::{Map, Value, json};

use crate::topics::{caption, policy, size_m};
use panels::{Panel, curve, titled, values};
use xcscr_robot::world::Maze;

/// The distance of the camera that follows the robot, in cells.
const FOLLOW: f64 = 9.0;
/// The factor by which the first camera is moved away if there is a second one.
const BESIDE: f64 = 1.25;

const BLUE: &str = "#1f77e0";
const RED: &str = "#e0473f";
const GREY: &str = "#b7bdc9";
/// The colours of the values of the actions.
const ACTIONS: [&str; 8] = [
    "#4e98e2", "#f5774d", "#5cd6a9", "#a395e2", "#f7df71", "#61cbff", "#cad660", "#8a8f99",
];
/// The colours of lights: nothing yet, under way, good, not so good, bad.
const NONE: &str = "#8a93a6";
const UNDER_WAY: &str = "#4e98e2";
const GOOD: &str = "#3ecf8e";
const FAIR: &str = "#f7df71";
const BAD: &str = "#f5774d";
const ENDINGS: [[&str; 3]; 2] = [
    ["step-limit", "step limit", BAD],
    ["goal", "goal reached", GOOD],
];
const OPTIMAL: [[&str; 3]; 2] = [["false", "not optimal", FAIR], ["true", "optimal", GOOD]];

/// Returns a layout of panels in this arrangement, with the speed of the playback.
fn layout(panels: Vec<Panel>, arrangement: &Value, speed: u32) -> String {
    let panels = panels.into_iter().map(|(id, state)| (id.to_owned(), state));
    let layout = json!({
        "configById": panels.collect::<Map<_, _>>(),
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": { "speed": speed },
        "layout": arrangement,
    });
    layout.to_string()
}

/// Aims the camera of a 3D panel at the maze, and shows what is visible from there.
fn fit(panel: &mut Value, maze: &Maze) {
    aim(&mut panel["cameraState"], maze);
    if policy::is_large(maze) {
        panel["topics"]["/values"] = values("nearness", ["#e6ac0073", "#45106b73"]);
    }
}

/// Returns a panel with a camera that follows the robot, and moves the camera of the other panel away:
/// there is less room next to a second one.
fn following(main: &mut Value, maze: &Maze) -> Value {
    let mut panel = titled("Around the robot", main.clone());
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

/// Adds a curve for the value of each action to a plot.
fn with_actions((id, mut plot): Panel, values: &str, maze: &Maze) -> Panel {
    let actions = maze.moves().directions().iter().zip(ACTIONS).enumerate();
    let curves = actions.map(|(action, (direction, color))| {
        curve(&format!("{values}[{action}]"), direction.name(), color)
    });
    plot["paths"]
        .as_array_mut()
        .into_iter()
        .for_each(|paths| paths.extend(curves.clone()));
    plot["showLegend"] = json!(true);
    (id, plot)
}
