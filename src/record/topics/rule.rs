//! `/rule` and `/scene/rule`: why an action was selected, as text, from the decision on.

use foxglove::messages::SceneUpdate;

use super::fields::{Fields, fields};
use super::scene::{ROBOT, entity, label, place, update};
use super::{Topic, to_parts};
use crate::agent::DecisionSource;
use crate::episode::Step;
use crate::sensor::Sensor;
use crate::world::Maze;
use xcs::Action;

/// Colours of actions selected by rules or a table, and of exploratory ones.
const CHOSEN: u32 = 0xffffff;
const EXPLORED: u32 = 0xf4b740;
/// The number of letters per line above the robot, and the maximum number of lines with demands.
const LETTERS: usize = 26;
const LINES: usize = 2;
/// The letter height, as a share of a cell and of the longer side of the maze; the larger one
/// applies.
const LETTER: [f64; 2] = [0.23, 0.028];
/// The height of the lowest line above the floor and the line spacing, in letters.
const FIRST: f64 = 3.6;
const NEXT: f64 = 2.5;
/// The visible share of an upright object's height, because the camera looks down steeply.
const SEEN_UPRIGHT: f64 = 0.9;
/// The name of the action where the agent sets the speeds of the wheels.
pub(super) const WHEELS: &str = "wheels";
/// Why an action was selected, as text.
#[derive(Debug)]
pub(in crate::record) struct Reasons {
    because: String,
    /// The action and its value.
    choice: String,
    explored: bool,
}

impl Reasons {
    /// Returns the reasons of a step's decision.
    pub fn of(step: &Step<'_>, sensor: Sensor) -> Self {
        let (because, choice) = match step.view.wheels_mps {
            Some([left, right]) => {
                let speeds = format!("left {left:.2} m/s, right {right:.2} m/s");
                (WHEELS.to_owned(), speeds)
            }
            None => (because(step, sensor), value(step, step.action)),
        };
        Self {
            because,
            choice,
            explored: step.explored,
        }
    }

    /// Returns the message about the decision of a step; `goal` is the reward for reaching a goal.
    pub fn record(&self, step: &Step<'_>, sensor: Sensor, goal: f64) -> Fields {
        let maze = step.view.maze;
        let action = match step.view.wheels_mps {
            Some(_) => WHEELS.to_owned(),
            None => maze.action_name(step.action),
        };
        let heading = Topic::Rule.number("heading", &action);
        let (because, choice) = (&self.because, &self.choice);
        fields! { "rule.json":
            episode: step.episode,
            step: step.step,
            rule: format!("{because} -> {choice}{}", support(step)),
            runner_up: runner_up(step).map_or_else(String::new, |other| value(step, other)),
            chosen_by: step.source.name(),
            explored: step.explored,
            action: action,
            heading: heading,
            seen: sensor.words(maze, &|at| Some(step.percept.bit(at))),
            percept: step.percept,
            left: left_percent(step),
            values: value_percent(step, goal),
        }
    }

    /// Creates the scene with the reasons as text above the robot, legible from everywhere.
    pub fn scene(&self, maze: &Maze, time_ns: u64) -> SceneUpdate {
        let height = letter_m(maze);
        let rgb = if self.explored { EXPLORED } else { CHOSEN };
        let lines = abbreviated(&self.because).into_iter().rev();
        let lines = [format!("-> {}", self.choice)].into_iter().chain(lines);
        let mut words = entity("rule", ROBOT, time_ns);
        // The camera looks down steeply, so upright text appears a little lower.
        let upwards = (0..).map(|line| (FIRST + NEXT * f64::from(line)) * height);
        words.texts = lines
            .zip(upwards)
            .map(|(line, up)| label(place(0.0, 0.0, up), height, rgb, &line))
            .collect();
        update(vec![words])
    }
}

/// Returns how far the text above a robot in the northernmost free cells extends north of the maze
/// in the camera's view, in metres.
pub(super) fn reach_m(maze: &Maze) -> f64 {
    let top = (FIRST + NEXT * LINES as f64 + 0.5) * letter_m(maze);
    (SEEN_UPRIGHT * top - 1.5 * maze.cell_size_m()).max(0.0)
}

/// Returns the height of a letter, in metres.
fn letter_m(maze: &Maze) -> f64 {
    let side = f64::from(maze.width().max(maze.height())) * maze.cell_size_m();
    (LETTER[0] * maze.cell_size_m()).max(LETTER[1] * side)
}

/// Returns as many demands as fit above the robot, line by line. The least informative come last.
fn abbreviated(because: &str) -> Vec<String> {
    let demands = because.split(", ");
    let (weak, strong): (Vec<&str>, _) = demands.partition(|demand| demand.ends_with("no goal"));
    let mut lines = vec![String::new()];
    for demand in [strong, weak].concat() {
        let has_room = lines
            .last()
            .is_some_and(|line| line.len() + demand.len() <= LETTERS);
        let is_full = lines.len() == LINES;
        match lines.last_mut() {
            Some(line) if line.is_empty() => demand.clone_into(line),
            Some(line) if has_room => *line = format!("{line}, {demand}"),
            Some(line) if is_full => {
                line.push_str(", ...");
                break;
            }
            _ => lines.push(demand.to_owned()),
        }
    }
    lines
}

/// Returns the condition of the deciding rule as text, or the name of the decision source.
fn because(step: &Step<'_>, sensor: Sensor) -> String {
    let condition = step.fired();
    condition.map_or_else(
        || source_name(step.source).to_owned(),
        |condition| sensor.words(step.view.maze, &condition),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_above_the_robot_is_short_and_begins_with_the_most_informative_demand() {
        assert_eq!(
            abbreviated("north no goal, east free"),
            ["east free, north no goal"]
        );
        assert_eq!(abbreviated("explores by chance"), ["explores by chance"]);
        let long =
            "north wall, north-east wall, east free, south-east free, south-west wall, west wall";
        let wanted = [
            "north wall, north-east wall",
            "east free, south-east free, ...",
        ];
        assert_eq!(abbreviated(long), wanted);
    }
}
