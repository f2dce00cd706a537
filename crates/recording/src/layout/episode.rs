//! The layout for the files of single episodes.

use serde_json::{Value, json};

use super::panels::{Axis, Panel, Plot, column, indicator, log, raw, row, scene, states};
use super::{
    BAD, BLUE, ENDINGS, FAIR, GOOD, GREY, NONE, OPTIMAL, RED, UNDER_WAY, fit, following, layout,
    with_actions,
};
use crate::topics::policy;
use xcscr_robot::world::Maze;

/// The topics of the 3D panel.
const SCENES: [&str; 7] = [
    "/scene/maze",
    "/scene/caption",
    "/scene/robot",
    "/scene/policy",
    "/scene/trail",
    "/scene/percept",
    "/scene/rule",
];
const STEPS: [(&str, &str); 3] = [
    ("/rule.action", "action"),
    ("/rule.explored", "explored"),
    ("/step.outcome", "result"),
];
const OUTCOMES: [[&str; 3]; 4] = [
    ["moved", "moved", UNDER_WAY],
    ["collided", "collided", BAD],
    ["stalled", "stalled", FAIR],
    ["reached-goal", "in the goal", GOOD],
];

/// Returns the layout for the files of single episodes, as compact JSON.
pub fn of_episode(maze: &Maze) -> String {
    let mut main = main_scene(maze);
    let mut all = vec![states("StateTransitions!steps", "Steps", &STEPS)];
    all.extend(plots(maze));
    all.push(log());
    all.extend(lights());
    all.push(raw("RawMessages!rule", "Why this action", "/rule"));
    all.push(raw("RawMessages!step", "Step", "/step"));
    let view = match policy::is_large(maze) {
        true => {
            all.push(("3D!follow", following(&mut main.1, maze)));
            row(58, "3D!main", "3D!follow")
        }
        false => json!("3D!main"),
    };
    all.push(main);
    layout(all, &arrangement(view), 1)
}

fn main_scene(maze: &Maze) -> Panel {
    let title = "Robot, path and policy (ellipse of its estimate: 10 times as large)";
    let mut main = scene(title, &SCENES);
    main.1["topics"]["/scan"] = json!({
        "visible": true, "colorMode": "flat", "colorField": "range", "flatColor": "#c23ee8ff",
        "pointSize": 5, "decayTime": 0.2,
    });
    fit(&mut main.1, maze);
    main
}

fn plots(maze: &Maze) -> [Panel; 2] {
    let curve = Plot {
        id: "Plot!curve",
        title: "Steps and collisions by episode",
        x: Axis::Curve,
        curves: &[
            ("/curve.steps[:]", "steps", BLUE),
            ("/curve.collisions[:]", "collisions", RED),
        ],
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
    [
        curve.panel(),
        with_actions(values.panel(), "/rule.values", maze),
    ]
}

fn lights() -> [Panel; 3] {
    [
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
            &OUTCOMES,
        ),
    ]
}

/// Returns where the panels are, with this view of the robot.
fn arrangement(view: Value) -> Value {
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
    row(
        57,
        column(69, view, "StateTransitions!steps"),
        column(47, plots, column(20, lights, texts)),
    )
}
