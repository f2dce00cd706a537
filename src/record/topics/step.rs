//! `/step`: a step, at the time when its outcome is known.

use serde::Serialize;

use super::decimal;
use super::episode::decimals;
use crate::arena::Outcome;
use crate::episode::Step;
use xcs::{Percept, PredictionArray};

/// The percept, the decision and the outcome of a step.
#[derive(Debug, Serialize)]
pub(in crate::record) struct StepRecord {
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
    values: PredictionArray,
    error: f64,
    match_set: u32,
    action_set: u32,
}

impl StepRecord {
    pub fn new(step: &Step<'_>) -> Self {
        let name = |action| {
            let direction = step.view.maze.direction(action);
            direction.map_or("unknown", |direction| direction.name())
        };
        Self {
            episode: step.episode,
            step: step.step,
            col: step.cell.col,
            row: step.cell.row,
            percept: step.percept,
            action: name(step.action),
            executed: step.view.executed.map(name),
            explored: step.explored,
            chosen_by: step.chooser.name(),
            rule: step.fired().map_or_else(String::new, String::from),
            outcome: outcome(step.outcome).1,
            result: outcome(step.outcome).0,
            left: left(step),
            reward: decimal(step.credit.short_term_reward),
            values: step.values,
            error: decimal(step.credit.error),
            match_set: step.credit.match_set,
            action_set: step.credit.action_set,
        }
    }
}

/// The numbers and names of outcomes, as in `step.json`.
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
