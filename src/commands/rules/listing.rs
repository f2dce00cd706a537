//! Sorted lists of rules in words.

use std::cmp::Reverse;

use serde::Serialize;
use xcscr::agent::Knowledge;
use xcscr::sensor::Perception;
use xcscr::trial::Plan;
use xcscr::xcs::{Action, Classifier, Condition};

/// The columns of a [`Row`] in a file.
pub const COLUMNS: [&str; 10] = [
    "condition",
    "action",
    "if",
    "go",
    "covers",
    "prediction",
    "error",
    "fitness",
    "numerosity",
    "experience",
];

/// A row of a list of rules.
#[derive(Debug, Serialize)]
pub struct Row {
    pub condition: Condition,
    pub action: Action,
    #[serde(rename = "if")]
    pub words: String,
    pub go: String,
    pub covers: usize,
    pub prediction: f64,
    pub error: f64,
    pub fitness: f64,
    pub numerosity: u32,
    pub experience: u32,
    #[serde(skip)]
    pub rule: Classifier,
}

/// Returns the rules in words. Those that match the most percepts of the world come first; with earlier steps in the
/// percept, those that the greedy policy meets.
pub fn rows(rules: &[Classifier], plan: &Plan, knowledge: &Knowledge) -> Vec<Row> {
    let Plan { maze, config } = plan;
    let percepts = match config.perception() {
        // Rules of a learner with a model also match where it has no decision.
        Perception { sensor, history: 0 } => sensor.at_most_percepts(maze, usize::MAX),
        perception => knowledge.decided(perception, maze, usize::MAX),
    };
    let percepts = percepts.expect("the number is not limited");
    let row = |rule: &Classifier| Row {
        condition: rule.condition,
        action: rule.action,
        words: config.sensor.words(maze, &rule.condition),
        go: maze.action_name(rule.action),
        covers: percepts
            .iter()
            .filter(|p| rule.condition.matches(p))
            .count(),
        prediction: rule.prediction,
        error: rule.error,
        fitness: rule.fitness,
        numerosity: rule.numerosity,
        experience: rule.experience,
        rule: *rule,
    };
    let mut rows: Vec<Row> = rules.iter().map(row).collect();
    rows.sort_by_key(|row| Reverse(row.covers));
    rows
}
