//! Sorted lists of rules in words.

use std::cmp::Reverse;

use clap::ValueEnum;
use serde::Serialize;
use xcscr::agent::Knowledge;
use xcscr::sensor::Perception;
use xcscr::trial::Plan;
use xcscr::xcs::{Action, Classifier, Condition, Percept};

/// The sort order of rules.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum Order {
    /// The number of the world's percepts that the rule matches. With earlier steps in the percept: of those that the
    /// greedy policy meets.
    Covers,
    Action,
    Value,
    Error,
    Fitness,
    Numerosity,
    Experience,
}

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

/// Returns the rules that match a percept, or all rules, in the given order.
pub fn rows(
    rules: &[Classifier],
    (plan, knowledge): (&Plan, &Knowledge),
    here: Option<&Percept>,
    by: Order,
) -> Vec<Row> {
    let Plan { maze, config } = plan;
    let percepts = match config.perception() {
        // Rules of a learner with a model also match where it has no decision.
        Perception { sensor, history: 0 } => sensor.at_most_percepts(maze, usize::MAX),
        perception => knowledge.decided(perception, maze, usize::MAX),
    };
    let percepts = percepts.expect("the number is not limited");
    let matches = |rule: &&Classifier| here.is_none_or(|percept| rule.condition.matches(percept));
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
    let mut rows: Vec<Row> = rules.iter().filter(matches).map(row).collect();
    match by {
        Order::Covers => rows.sort_by_key(|row| Reverse(row.covers)),
        Order::Action => rows.sort_by_key(|row| row.action),
        Order::Value => rows.sort_by(|a, b| b.prediction.total_cmp(&a.prediction)),
        Order::Error => rows.sort_by(|a, b| a.error.total_cmp(&b.error)),
        Order::Fitness => rows.sort_by(|a, b| b.fitness.total_cmp(&a.fitness)),
        Order::Numerosity => rows.sort_by_key(|row| Reverse(row.numerosity)),
        Order::Experience => rows.sort_by_key(|row| Reverse(row.experience)),
    }
    rows
}
