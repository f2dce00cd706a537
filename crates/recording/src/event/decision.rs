//! `/rule`: why an action was selected, as text, from the decision on.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::topics::to_parts;
use xcs::Action;
use xcscr_learner::agent::DecisionSource;
use xcscr_learner::episode::Step;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::CellState;

/// The name of the action where the agent sets the speeds of the wheels.
const WHEELS: &str = "wheels";

/// The selection of an action, and its reasons.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Decision {
    /// Number of the episode, from 1.
    pub episode: u32,
    /// Number of the step, from 1 in each episode.
    pub step: u32,
    /// Column of the cell, from the west.
    pub col: u16,
    /// Row of the cell, from the north.
    pub row: u16,
    /// Chosen direction.
    pub action: String,
    /// What chose the action: rules, table, planner, chance.
    pub chosen_by: String,
    /// True if chosen to explore.
    pub explored: bool,
    /// Percept in words.
    pub seen: String,
    /// Percept as bits.
    pub percept: String,
    /// Rule of \[A\] with the greatest weight in words, its action, value and error, and how many of
    /// the rules in \[M\] advocate the action.
    pub rule: String,
    /// Best other action and its value.
    pub runner_up: String,
    /// Percentage of the step limit that is left, including this step.
    pub left: u32,
    /// Value of each action, clockwise from north, in percent of the reward at a goal; null if
    /// unknown.
    pub values: Vec<Option<f64>>,
    /// The demands of the rule in words, or the decision source. They are part of `rule`.
    #[serde(skip)]
    pub because: Vec<String>,
    /// The action and its value. It is part of `rule`.
    #[serde(skip)]
    pub choice: String,
}

impl Decision {
    /// Creates the event of a step's decision; `goal` is the reward for reaching a goal.
    pub fn of(step: &Step<'_>, sensor: Sensor, goal: f64) -> Self {
        let maze = step.view.maze;
        let (because, choice) = match step.view.wheels_mps {
            Some([left, right]) => {
                let speeds = format!("left {left:.2} m/s, right {right:.2} m/s");
                (vec![WHEELS.to_owned()], speeds)
            }
            None => (because(step, sensor), value(step, step.action)),
        };
        Self {
            episode: step.episode,
            step: step.step,
            col: step.cell.col,
            row: step.cell.row,
            action: action_name(step, step.action),
            chosen_by: step.source.name().to_owned(),
            explored: step.explored,
            seen: sensor.words(maze, &step.percept),
            percept: step.percept.to_string(),
            rule: format!("{} -> {choice}{}", because.join(", "), support(step)),
            runner_up: runner_up(step).map_or_else(String::new, |other| value(step, other)),
            left: left_percent(step),
            values: value_percent(step, goal),
            because,
            choice,
        }
    }
}

impl Decision {
    /// Returns the eight cells around the robot as it perceives them, clockwise from north; `None`
    /// if the sensor does not perceive them.
    pub fn perceived(&self, sensor: Sensor) -> Option<[CellState; 8]> {
        sensor.cells_around(&self.percept.parse().ok()?)
    }
}

/// Returns the name of an action of a step.
pub(super) fn action_name(step: &Step<'_>, action: Action) -> String {
    match step.view.wheels_mps {
        Some(_) => WHEELS.to_owned(),
        None => step.view.maze.action_name(action),
    }
}

/// Returns the demands of the deciding rule in words, or the name of the decision source.
fn because(step: &Step<'_>, sensor: Sensor) -> Vec<String> {
    let condition = step.fired();
    condition.map_or_else(
        || vec![source_name(step.source).to_owned()],
        |condition| sensor.demands(step.view.maze, &condition),
    )
}

fn source_name(source: DecisionSource) -> &'static str {
    match source {
        DecisionSource::Rules => "rules",
        DecisionSource::Table => "table",
        DecisionSource::Planner => "explores by plan",
        DecisionSource::Chance => "explores by chance",
    }
}

/// Returns an action and its value as text.
fn value(step: &Step<'_>, action: Action) -> String {
    let name = step.view.maze.action_name(action);
    let value = step
        .values
        .as_slice()
        .get(action.index())
        .copied()
        .flatten();
    value.map_or_else(|| name.clone(), |value| format!("{name}, value {value:.0}"))
}

/// Returns the percentage of the step-threshold that is left when the step is decided.
fn left_percent(step: &Step<'_>) -> u32 {
    let most = f64::from(step.method.step_threshold().max(1));
    (100.0 * (1.0 - f64::from(step.step - 1).min(most) / most)).round() as u32
}

/// Returns the value of each action, in percent of the reward for a goal.
fn value_percent(step: &Step<'_>, goal: f64) -> Vec<Option<f64>> {
    let all = if goal > 0.0 { goal } else { 100.0 };
    let values = step.values.as_slice().iter();
    values
        .map(|value| value.map(|value| to_parts(100.0 * value / all, 10.0)))
        .collect()
}

/// Returns the error, and how many of the matching rules advocate the action.
fn support(step: &Step<'_>) -> String {
    let credit = &step.credit;
    match credit.match_set {
        0 => String::new(),
        all => format!(
            " ± {:.0}, {} of {all} matching rules agree",
            credit.error, credit.action_set
        ),
    }
}

/// Returns the best of the actions that were not taken.
fn runner_up(step: &Step<'_>) -> Option<Action> {
    let known = Action::all(step.values.as_slice().len()).zip(step.values.as_slice());
    let others = known.filter_map(|(action, values)| Some((action, (*values)?)));
    let others = others.filter(|&(action, _)| action != step.action);
    let best = others.reduce(|best, next| if next.1 > best.1 { next } else { best });
    best.map(|(action, _)| action)
}
