//! Explanations of the rules' choice in a cell.

use super::plan::Plan;
use crate::agent::Knowledge;
use xcs::{Classifier, Percept, Population, PredictionArray};
use xcscr_robot::world::Cell;

/// The evaluation of a percept by the rules.
#[derive(Debug, Clone)]
pub struct Why {
    /// The percept.
    pub percept: Percept,
    /// The values of the actions.
    pub values: PredictionArray,
    /// The matching rules: those of the best actions first, and for each action the greatest share
    /// first.
    pub votes: Vec<WeightedRule>,
}

/// A matching rule.
#[derive(Debug, Clone, Copy)]
pub struct WeightedRule {
    /// The rule.
    pub rule: Classifier,
    /// Its share of the value of its action, 0 to 1 (Eq. 6: by fitness).
    pub share: f64,
}

impl Why {
    /// Explains the choice of the rules in a free cell, at the beginning of an episode.
    pub fn at(plan: &Plan, knowledge: &Knowledge, cell: Cell) -> Self {
        let Plan { maze, config } = plan;
        let percept = config.perception().at(maze, cell);
        let values = knowledge.values(&percept, maze.action_count());
        Self {
            votes: votes(knowledge, &percept, &values),
            percept,
            values,
        }
    }
}

/// Returns the rules that match a percept, with their shares.
fn votes(knowledge: &Knowledge, percept: &Percept, values: &PredictionArray) -> Vec<WeightedRule> {
    let rules = knowledge.rules().map_or(&[][..], Population::rules);
    let matching = rules.iter().filter(|rule| rule.condition.matches(percept));
    let matching: Vec<Classifier> = matching.copied().collect();
    let fitness_of = |action| {
        let rules = matching.iter().filter(move |rule| rule.action == action);
        rules.map(|rule| rule.fitness).sum::<f64>()
    };
    let vote = |rule: &Classifier| WeightedRule {
        rule: *rule,
        share: rule.fitness / fitness_of(rule.action),
    };
    let mut votes: Vec<WeightedRule> = matching.iter().map(vote).collect();
    let rank = |vote: &WeightedRule| values.get(vote.rule.action).unwrap_or(f64::NEG_INFINITY);
    votes.sort_by(|a, b| {
        let by_value = rank(b).total_cmp(&rank(a));
        by_value
            .then(a.rule.action.cmp(&b.rule.action))
            .then(b.share.total_cmp(&a.share))
    });
    votes
}
