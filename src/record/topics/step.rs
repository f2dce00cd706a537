//! `/step`: a step, at the time when its outcome is known.

use super::Topic;
use super::fields::{Fields, fields};
use super::rule::WHEELS;
use crate::arena::Outcome;
use crate::episode::Step;

/// Returns the percept, the decision and the outcome of a step.
pub(in crate::record) fn record(step: &Step<'_>) -> Fields {
    let name = |action| {
        let direction = step.view.maze.direction(action);
        let other = step.view.wheels_mps.map_or("unknown", |_| WHEELS);
        direction.map_or(other, |direction| direction.name())
    };
    let outcome = outcome(step.outcome);
    fields! { "step.json":
        episode: step.episode,
        step: step.step,
        col: step.cell.col,
        row: step.cell.row,
        percept: step.percept,
        action: name(step.action),
        executed: step.view.executed.map(name),
        explored: step.explored,
        chosen_by: step.source.name(),
        rule: step.fired().map_or_else(String::new, String::from),
        outcome: outcome,
        result: Topic::Step.number("result", outcome),
        left: left(step),
        reward: step.credit.short_term_reward,
        values: step.values.as_slice(),
        error: step.credit.error,
        match_set: step.credit.match_set,
        action_set: step.credit.action_set,
    }
}

/// Returns the name of an outcome.
fn outcome(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Moved => "moved",
        Outcome::Collided { .. } => "collided",
        Outcome::Stalled => "stalled",
        Outcome::ReachedGoal => "reached-goal",
        Outcome::FoundReward { .. } => "found-reward",
    }
}

/// Returns the share of the step-threshold that is left.
fn left(step: &Step<'_>) -> f64 {
    let most = step.method.step_threshold().max(1);
    1.0 - f64::from(step.step.min(most)) / f64::from(most)
}
