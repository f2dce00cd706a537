//! Explanations of the rules' choice in a cell, and counterfactual percepts.

use std::collections::BTreeSet;

use super::plan::Plan;
use crate::agent::Knowledge;
use xcs::{Action, Classifier, Percept, Population, PredictionArray};
use xcscr_robot::sensor::{Perception, Sensor};
use xcscr_robot::world::{Cell, Maze};

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
    /// For each action that is not one of the best, the least change that would make it the only
    /// best action. Actions without such a change are omitted.
    pub changes: Vec<Change>,
}

/// A matching rule.
#[derive(Debug, Clone, Copy)]
pub struct WeightedRule {
    /// The rule.
    pub rule: Classifier,
    /// Its share of the value of its action, 0 to 1 (Eq. 6: by fitness).
    pub share: f64,
}

/// A change of the percept that makes another action the choice.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The action.
    pub action: Action,
    /// The differences of the percept, in words.
    pub words: Vec<String>,
    /// A cell with this percept; `None` if there is none in this world.
    pub cell: Option<Cell>,
}

impl Why {
    /// Explains the choice of the rules in a free cell, at the beginning of an episode.
    pub fn at(plan: &Plan, knowledge: &Knowledge, cell: Cell) -> Self {
        let Plan { maze, config } = plan;
        let percept = config.perception().at(maze, cell);
        let values = knowledge.values(&percept, maze.action_count());
        Self {
            votes: votes(knowledge, &percept, &values),
            changes: changes(plan, knowledge, &percept, &values),
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

/// Returns the least change for each action that is not one of the best.
fn changes(
    plan: &Plan,
    knowledge: &Knowledge,
    percept: &Percept,
    values: &PredictionArray,
) -> Vec<Change> {
    let Plan { maze, config } = plan;
    let best: Vec<Action> = values.best_actions().collect();
    let candidates = candidates(config.perception(), maze, percept);
    let others = Action::all(maze.action_count()).filter(|action| !best.contains(action));
    let change = |action| {
        let leads_to = |candidate: &&Candidate| {
            let values = knowledge.values(&candidate.percept, maze.action_count());
            values.greatest().is_some() && values.best_actions().all(|one| one == action)
        };
        let found = candidates.iter().find(leads_to)?;
        let (words, cell) = (found.words.clone(), found.cell);
        Some(Change {
            action,
            words,
            cell,
        })
    };
    others.filter_map(change).collect()
}

/// Another percept, its differences, and a cell with this percept.
struct Candidate {
    percept: Percept,
    words: Vec<String>,
    cell: Option<Cell>,
}

/// Returns all percepts of the world, and percepts in which one or two surrounding cells differ.
/// The smallest differences come first, and among equal ones the percepts that occur in the world.
fn candidates(perception: Perception, maze: &Maze, percept: &Percept) -> Vec<Candidate> {
    let sensor = perception.sensor;
    let here = words(sensor, maze, percept);
    let candidate = |(percept, cell): (Percept, Option<Cell>)| Candidate {
        words: words(sensor, maze, &percept)
            .into_iter()
            .filter(|word| !here.contains(word))
            .collect(),
        percept,
        cell,
    };
    let cells = maze.free_cells().filter(|&cell| !maze.is_goal(cell));
    let real = cells.map(|cell| (perception.at(maze, cell), Some(cell)));
    let one = sensor.changed_surroundings(percept);
    let two = one.iter().flat_map(|one| sensor.changed_surroundings(one));
    let simulated = one
        .iter()
        .copied()
        .chain(two)
        .map(|percept| (percept, None));
    let mut seen = BTreeSet::from([*percept]);
    let all = real
        .chain(simulated)
        .filter(|(percept, _)| seen.insert(*percept));
    let mut candidates: Vec<Candidate> = all.map(candidate).collect();
    candidates.sort_by_key(|candidate| candidate.words.len());
    candidates
}

/// Returns the parts of the description of a percept.
fn words(sensor: Sensor, maze: &Maze, percept: &Percept) -> Vec<String> {
    let words = sensor.words(maze, percept);
    words.split(", ").map(str::to_owned).collect()
}
