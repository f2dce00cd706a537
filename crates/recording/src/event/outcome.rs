//! `/step`: a step, at the time when its outcome is known.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::decision::action_name;
use xcscr_learner::episode::Step;
use xcscr_robot::arena;

/// The percept, the decision and the outcome of a step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StepOutcome {
    /// Number of the episode, from 1.
    pub episode: u32,
    /// Number of the step, from 1 in each episode.
    pub step: u32,
    /// Column of the cell before the step, from the west.
    pub col: u16,
    /// Row of the cell before the step, from the north.
    pub row: u16,
    /// Percept in that cell as bits.
    pub percept: String,
    /// Chosen direction.
    pub action: String,
    /// Executed direction, if actions slip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub executed: Option<String>,
    /// True if chosen to explore.
    pub explored: bool,
    /// What chose the action: rules, table, planner, chance.
    pub chosen_by: String,
    /// Condition of the rule that decided.
    pub rule: String,
    // Earlier versions wrote `found-reward`, and the text of a schema is part of a recording's bytes.
    /// Outcome: moved, collided, stalled, reached-goal, found-reward.
    pub outcome: String,
    /// Share of the step limit that is left.
    pub left: f64,
    /// Short-term reward.
    pub reward: f64,
    /// Value of each action, clockwise from north; null if unknown.
    pub values: Vec<Option<f64>>,
    /// Mean prediction error of \[A\], in units of reward.
    pub error: f64,
    /// Micro-classifiers in \[M\].
    pub match_set: u32,
    /// Micro-classifiers in \[A\].
    pub action_set: u32,
}

impl StepOutcome {
    /// Creates the event of a step.
    pub fn of(step: &Step<'_>) -> Self {
        Self {
            episode: step.episode,
            step: step.step,
            col: step.cell.col,
            row: step.cell.row,
            percept: step.percept.to_string(),
            action: action_name(step, step.action),
            executed: step.view.executed.map(|action| action_name(step, action)),
            explored: step.explored,
            chosen_by: step.source.name().to_owned(),
            rule: step.fired().map_or_else(String::new, String::from),
            outcome: outcome(step.outcome).to_owned(),
            left: left(step),
            reward: step.credit.short_term_reward,
            values: step.values.as_slice().to_vec(),
            error: step.credit.error,
            match_set: step.credit.match_set,
            action_set: step.credit.action_set,
        }
    }
}

/// Returns the name of an outcome.
fn outcome(outcome: arena::Outcome) -> &'static str {
    match outcome {
        arena::Outcome::Moved => "moved",
        arena::Outcome::Collided { .. } => "collided",
        arena::Outcome::Stalled => "stalled",
        arena::Outcome::ReachedGoal => "reached-goal",
    }
}

/// Returns the share of the step-threshold that is left.
fn left(step: &Step<'_>) -> f64 {
    let most = step.method.step_threshold().max(1);
    1.0 - f64::from(step.step.min(most)) / f64::from(most)
}
