//! What was learned in a maze, in few rules.

use crate::agent::{Frozen, Knowledge};
use crate::episode::FaultFinder;
use crate::sensor::Sensor;
use crate::world::{Maze, Paths};
use xcs::{Population, compact};

/// Rules are condensed in worlds of at most this many different percepts; beyond, it would take
/// minutes.
pub const MOST_PERCEPTS: usize = 4096;

/// The rules of a learner condensed for a maze, and put to the test there.
#[derive(Debug, Clone, PartialEq)]
pub struct Condensed {
    /// The condensed rules.
    pub rules: Population,
    /// The percepts of the maze of which the learner knows anything.
    pub percepts: usize,
    /// In how many of these the condensed rules choose only actions that the learner rates best.
    pub agreeing: usize,
    /// Is the condensed policy globally optimal?
    pub optimal: bool,
}

impl Condensed {
    /// Condenses what was learned; `None` for a table, which has no rules, for rules that look at
    /// more than the percept, and in worlds with more than [`MOST_PERCEPTS`] different percepts.
    pub fn new(knowledge: &Knowledge, sensor: Sensor, maze: &Maze, paths: &Paths) -> Option<Self> {
        let actions = maze.action_count();
        if knowledge.remembers() {
            return None;
        }
        let percepts = sensor.at_most_percepts(maze, MOST_PERCEPTS)?;
        let worth = |percept: &_| knowledge.worth(percept, actions);
        let rules = compact(knowledge.rules()?, &percepts, worth);
        let condensed = Knowledge::Rules(rules.clone());
        let known = percepts.iter().filter(|p| worth(p).greatest().is_some());
        let agrees = |percept: &_| {
            let wanted = worth(percept);
            let chosen = condensed.worth(percept, actions);
            let is_wanted = |action| wanted.best_actions().any(|best| best == action);
            chosen.greatest().is_some() && chosen.best_actions().all(is_wanted)
        };
        let frozen = Frozen::new(condensed.clone(), actions, 1);
        let fault = FaultFinder::default().find(&frozen, sensor, maze, paths);
        Some(Self {
            percepts: known.clone().count(),
            agreeing: known.filter(|percept| agrees(percept)).count(),
            optimal: fault.is_none(),
            rules,
        })
    }
}
