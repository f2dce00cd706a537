//! `/step`: a step, at the time when its outcome is known.

use serde::{Serialize, Serializer};

use super::schema::Object;
use super::{decimal, episode};
use crate::arena::Outcome;
use crate::episode::Step;
use xcs::{Percept, PredictionArray};

/// The percept, the decision and the outcome of a step.
#[derive(Debug, Serialize)]
pub(in crate::record) struct StepRecord<'a> {
    episode: u32,
    step: u32,
    col: u16,
    row: u16,
    percept: Percept,
    action: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    executed: Option<&'static str>,
    explored: bool,
    chosen_by: &'static str,
    rule: String,
    outcome: &'static str,
    result: u8,
    left: f64,
    reward: f64,
    #[serde(serialize_with = "decimals")]
    values: &'a PredictionArray,
    error: f64,
    match_set: u32,
    action_set: u32,
}

impl<'a> StepRecord<'a> {
    pub fn new(step: &'a Step<'_>) -> Self {
        let direction = step.view.maze.direction(step.action);
        Self {
            episode: step.episode,
            step: step.step,
            col: step.cell.col,
            row: step.cell.row,
            percept: step.percept,
            action: direction.map_or("unknown", |d| d.name()),
            executed: step.view.executed.map(|action| {
                let direction = step.view.maze.direction(action);
                direction.map_or("unknown", |d| d.name())
            }),
            explored: step.explored,
            chosen_by: step.chooser.name(),
            rule: step.fired().map_or_else(String::new, String::from),
            outcome: outcome(step.outcome).1,
            result: outcome(step.outcome).0,
            left: left(step),
            reward: decimal(step.credit.short_term_reward),
            values: &step.values,
            error: decimal(step.credit.error),
            match_set: step.credit.match_set,
            action_set: step.credit.action_set,
        }
    }
}

fn decimals<S: Serializer>(values: &&PredictionArray, serializer: S) -> Result<S::Ok, S::Error> {
    episode::decimals(values, serializer)
}

/// The numbers and names of outcomes in files.
const OUTCOMES: [(u8, &str); 5] = [
    (0, "moved"),
    (1, "collided"),
    (2, "stalled"),
    (3, "reached-goal"),
    (4, "found-reward"),
];

fn outcome(outcome: Outcome) -> (u8, &'static str) {
    OUTCOMES[match outcome {
        Outcome::Moved => 0,
        Outcome::Collided { .. } => 1,
        Outcome::Stalled => 2,
        Outcome::ReachedGoal => 3,
        Outcome::FoundReward { .. } => 4,
    }]
}

/// Returns the share of the step-threshold that is left.
fn left(step: &Step<'_>) -> f64 {
    let most = step.method.step_threshold().max(1);
    decimal(1.0 - f64::from(step.step.min(most)) / f64::from(most))
}

pub(super) fn schema() -> Object {
    Object::new("xcscr.Step")
        .count("episode", "from 1")
        .count("step", "from 1 in each episode")
        .count("col", "cell before the step, from the west")
        .count("row", "cell before the step, from the north")
        .text("percept", "bits perceived there")
        .text("action", "direction chosen")
        .text("executed", "direction carried out, where actions slip")
        .bool("explored", "chosen to explore?")
        .text("chosen_by", "rules, table, planner, chance")
        .text("rule", "condition of the rule that decided")
        .text(
            "outcome",
            "moved, collided, stalled, reached-goal, found-reward",
        )
        .named("result", &OUTCOMES, "the outcome as a number")
        .number("left", "share of the step-threshold that is left")
        .number("reward", "short-term reward")
        .numbers(
            "values",
            "of each action, clockwise from north; null: unknown",
        )
        .number("error", "mean prediction error of [A], in reward")
        .count("match_set", "micro-classifiers in [M]")
        .count("action_set", "micro-classifiers in [A]")
}
