//! Layouts for Foxglove and Lichtblick, fitted to a maze.

mod panels;

use serde_json::{Map, Value, json};

use crate::topics::{caption, policy, size_m};
use panels::{
    Axis, Curve, Panel, Plot, column, curve, gauge, indicator, log, raw, row, scene, states,
    titled, values,
};
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

/// Returns the layout for the files of single episodes, as compact JSON.
pub fn of_episode(maze: &Maze) -> String {
    let curves: [Curve; 2] = [
        ("/curve.steps[:]", "steps", BLUE),
        ("/curve.collisions[:]", "collisions", RED),
    ];
    let curve = Plot {
        id: "Plot!curve",
        title: "Steps and collisions by episode",
        x: Axis::Curve,
        curves: &curves,
        legend: 190,
        values: true,
    };
    let values = Plot {
        id: "Plot!values",
        title: "Steps left, and value of each action (% of the goal)",
        x: Axis::Time,
        curves: &[("/rule.left", "steps left", GREY)],
        legend: 190,
        values: true,
    };
    let steps = [
        ("/rule.action", "action"),
        ("/rule.explored", "explored"),
        ("/step.outcome", "result"),
    ];
    let outcomes = [
        ["moved", "moved", UNDER_WAY],
        ["collided", "collided", BAD],
        ["stalled", "stalled", FAIR],
        ["reached-goal", "in the goal", GOOD],
    ];
    let mut main = scene(
        "Robot, path and policy (ellipse of its estimate: 10 times as large)",
        &[
            "/scene/maze",
            "/scene/caption",
            "/scene/robot",
            "/scene/policy",
            "/scene/trail",
            "/scene/percept",
            "/scene/rule",
        ],
    );
    main.1["topics"]["/scan"] = json!({
        "visible": true, "colorMode": "flat", "colorField": "range", "flatColor": "#c23ee8ff",
        "pointSize": 5, "decayTime": 0.2,
    });
    fit(&mut main.1, maze);
    let mut all = vec![
        states("StateTransitions!steps", "Steps", &steps),
        curve.panel(),
        with_actions(values.panel(), "/rule.values", maze),
        log(),
        indicator(
            "Indicator!episode",
            "Episode",
            "/episode.outcome",
            ["running", UNDER_WAY],
            &ENDINGS,
        ),
        indicator(
            "Indicator!policy",
            "Policy at the start",
            "/begin.optimal",
            ["nothing yet", NONE],
            &OPTIMAL,
        ),
        indicator(
            "Indicator!step",
            "Step",
            "/step.outcome",
            ["no step yet", NONE],
            &outcomes,
        ),
        raw("RawMessages!rule", "Why this action", "/rule"),
        raw("RawMessages!step", "Step", "/step"),
    ];
    let view = match policy::is_large(maze) {
        true => {
            all.push(("3D!follow", following(&mut main.1, maze)));
            row(58, "3D!main", "3D!follow")
        }
        false => json!("3D!main"),
    };
    all.push(main);
    let lights = row(
        34,
        "Indicator!episode",
        row(50, "Indicator!policy", "Indicator!step"),
    );
    let texts = row(
        42,
        "RosOut!log",
        column(62, "RawMessages!rule", "RawMessages!step"),
    );
    let plots = column(44, "Plot!curve", "Plot!values");
    let arrangement = row(
        57,
        column(69, view, "StateTransitions!steps"),
        column(47, plots, column(20, lights, texts)),
    );
    layout(all, &arrangement, 1)
}

/// Returns the layout for `run.mcap`, as compact JSON.
pub fn of_run(maze: &Maze) -> String {
    let plot = |id, title, x, curves, legend, values| {
        let plot = Plot {
            id,
            title,
            x,
            curves,
            legend,
            values,
        };
        plot.panel()
    };
    let episodes = [
        ("/episode.outcome", "result"),
        ("/episode.optimal", "optimal"),
        ("/episode.imprinted", "imprinted"),
    ];
    let steps: [Curve; 4] = [
        ("/episode.steps", "steps", BLUE),
        ("/episode.collisions", "hits", RED),
        ("/episode.step_threshold", "limit", GREY),
        ("/episode.shortest", "shortest", "#35c46a"),
    ];
    let rules: [Curve; 2] = [
        ("/episode.rules", "macro", "#8a5cf0"),
        ("/episode.micro", "micro", "#12b5c9"),
    ];
    let sets: [Curve; 2] = [
        ("/step.match_set", "[M]", BLUE),
        ("/step.action_set", "[A]", "#ff8c1a"),
    ];
    let generality = [("/episode.generality", "generality", "#17a673")];
    let error = [("/episode.mean_error", "mean error", RED)];
    let values = plot(
        "Plot!values",
        "Value of each action in the start cell, by time",
        Axis::Time,
        &[],
        195,
        true,
    );
    let mut main = scene(
        "Policy and last path",
        &[
            "/scene/maze",
            "/scene/caption",
            "/scene/policy",
            "/scene/trail",
        ],
    );
    fit(&mut main.1, maze);
    let all = vec![
        main,
        states("StateTransitions!episodes", "Episodes", &episodes),
        plot(
            "Plot!curve",
            "Learning curve, by episode",
            Axis::Episode,
            &steps,
            195,
            true,
        ),
        plot(
            "Plot!time",
            "Steps and collisions, by time",
            Axis::Time,
            &steps[..2],
            115,
            false,
        ),
        with_actions(values, "/episode.start_values", maze),
        plot(
            "Plot!rules",
            "Rules in [P]: macro, micro",
            Axis::Episode,
            &rules,
            135,
            false,
        ),
        plot(
            "Plot!generality",
            "Generality",
            Axis::Episode,
            &generality,
            150,
            true,
        ),
        plot("Plot!error", "Mean error", Axis::Episode, &error, 150, true),
        plot(
            "Plot!sets",
            "[M] and [A], by time",
            Axis::Time,
            &sets,
            100,
            false,
        ),
        gauge("Gauge!left", "Steps left", "/step.left", 1.0, "colormap"),
        gauge(
            "Gauge!rate",
            "Learning rate",
            "/episode.learning_rate",
            0.25,
            "gradient",
        ),
        log(),
        indicator(
            "Indicator!episode",
            "Last episode",
            "/episode.outcome",
            ["first episode", UNDER_WAY],
            &ENDINGS,
        ),
        indicator(
            "Indicator!policy",
            "Policy",
            "/episode.optimal",
            ["nothing yet", NONE],
            &OPTIMAL,
        ),
    ];
    let plots = column(
        50,
        row(54, "Plot!curve", "Plot!time"),
        row(56, "Plot!values", "Plot!rules"),
    );
    let small = row(40, "Plot!sets", row(50, "Plot!generality", "Plot!error"));
    let lights = row(50, "Indicator!episode", "Indicator!policy");
    let gauges = row(50, "Gauge!left", "Gauge!rate");
    let texts = row(42, "RosOut!log", column(40, lights, gauges));
    let arrangement = row(
        44,
        column(69, "3D!main", "StateTransitions!episodes"),
        column(44, plots, column(38, small, texts)),
    );
    layout(all, &arrangement, 5)
}

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
