//! The layout for `run.mcap`.

use serde_json::Value;

use super::panels::{Axis, Curve, Panel, Plot, column, gauge, indicator, log, row, scene, states};
use super::{BLUE, ENDINGS, GREY, NONE, OPTIMAL, RED, UNDER_WAY, fit, layout, with_actions};
use xcscr_robot::world::Maze;

/// The topics of the 3D panel.
const SCENES: [&str; 4] = [
    "/scene/maze",
    "/scene/caption",
    "/scene/policy",
    "/scene/trail",
];
const EPISODES: [(&str, &str); 3] = [
    ("/episode.outcome", "result"),
    ("/episode.optimal", "optimal"),
    ("/episode.imprinted", "imprinted"),
];
const STEPS: [Curve; 4] = [
    ("/episode.steps", "steps", BLUE),
    ("/episode.collisions", "hits", RED),
    ("/episode.step_threshold", "limit", GREY),
    ("/episode.shortest", "shortest", "#35c46a"),
];
const RULES: [Curve; 2] = [
    ("/episode.rules", "macro", "#8a5cf0"),
    ("/episode.micro", "micro", "#12b5c9"),
];
const SETS: [Curve; 2] = [
    ("/step.match_set", "[M]", BLUE),
    ("/step.action_set", "[A]", "#ff8c1a"),
];
const GENERALITY: [Curve; 1] = [("/episode.generality", "generality", "#17a673")];
const ERROR: [Curve; 1] = [("/episode.mean_error", "mean error", RED)];

const PLOTS: [Plot<'static>; 7] = [
    Plot {
        id: "Plot!curve",
        title: "Learning curve, by episode",
        x: Axis::Episode,
        curves: &STEPS,
        legend: 195,
        values: true,
    },
    Plot {
        id: "Plot!time",
        title: "Steps and collisions, by time",
        x: Axis::Time,
        curves: &[STEPS[0], STEPS[1]],
        legend: 115,
        values: false,
    },
    Plot {
        id: "Plot!values",
        title: "Value of each action in the start cell, by time",
        x: Axis::Time,
        curves: &[],
        legend: 195,
        values: true,
    },
    Plot {
        id: "Plot!rules",
        title: "Rules in [P]: macro, micro",
        x: Axis::Episode,
        curves: &RULES,
        legend: 135,
        values: false,
    },
    Plot {
        id: "Plot!generality",
        title: "Generality",
        x: Axis::Episode,
        curves: &GENERALITY,
        legend: 150,
        values: true,
    },
    Plot {
        id: "Plot!error",
        title: "Mean error",
        x: Axis::Episode,
        curves: &ERROR,
        legend: 150,
        values: true,
    },
    Plot {
        id: "Plot!sets",
        title: "[M] and [A], by time",
        x: Axis::Time,
        curves: &SETS,
        legend: 100,
        values: false,
    },
];

/// Returns the layout for `run.mcap`, as compact JSON.
pub fn of_run(maze: &Maze) -> String {
    let mut main = scene("Policy and last path", &SCENES);
    fit(&mut main.1, maze);
    let mut all = vec![
        main,
        states("StateTransitions!episodes", "Episodes", &EPISODES),
    ];
    all.extend(PLOTS.iter().map(|plot| match plot.id {
        "Plot!values" => with_actions(plot.panel(), "/episode.start_values", maze),
        _ => plot.panel(),
    }));
    all.extend(gauges());
    all.push(log());
    all.extend(lights());
    layout(all, &arrangement(), 5)
}

fn gauges() -> [Panel; 2] {
    [
        gauge("Gauge!left", "Steps left", "/step.left", 1.0, "colormap"),
        gauge(
            "Gauge!rate",
            "Learning rate",
            "/episode.learning_rate",
            0.25,
            "gradient",
        ),
    ]
}

fn lights() -> [Panel; 2] {
    [
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
    ]
}

/// Returns where the panels are.
fn arrangement() -> Value {
    let plots = column(
        50,
        row(54, "Plot!curve", "Plot!time"),
        row(56, "Plot!values", "Plot!rules"),
    );
    let small = row(40, "Plot!sets", row(50, "Plot!generality", "Plot!error"));
    let lights = row(50, "Indicator!episode", "Indicator!policy");
    let gauges = row(50, "Gauge!left", "Gauge!rate");
    let texts = row(42, "RosOut!log", column(40, lights, gauges));
    row(
        44,
        column(69, "3D!main", "StateTransitions!episodes"),
        column(44, plots, column(38, small, texts)),
    )
}
