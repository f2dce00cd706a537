//! Explanations of decisions.

use super::setup::DriveSetup;
use super::step::Decision;
use crate::agent::Frozen;

/// Adds the rule with the largest weight and a text that explains the decision.
pub fn explain(decision: &mut Decision, setup: &DriveSetup, policy: &Frozen) {
    decision.rule = policy.decisive_rule(&decision.percept, decision.action);
    let maze = &setup.maze;
    let because = match &decision.rule {
        Some(rule) => setup.sensor.words(maze, rule),
        None if decision.values.greatest().is_none() => "nothing is known here".to_owned(),
        None => "the values decide".to_owned(),
    };
    let percept = decision.percept;
    let seen = setup.sensor.words(maze, &percept);
    let value = decision.values.get(decision.action);
    let value = value.map_or_else(String::new, |value| format!(" (value {value:.0})"));
    let (cell, action) = (decision.cell, maze.action_name(decision.action));
    decision.words = format!(
        "cell {},{}: {action}{value} because {because}; seen: {seen}",
        cell.col, cell.row
    );
}
