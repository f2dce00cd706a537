//! Learned rules, compacted for a maze.

use crate::agent::{Frozen, Knowledge};
use crate::episode::FaultFinder;
use xcs::{Population, compact};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Maze, Paths};

/// The rules of a learner, compacted for a maze and tested there.
#[derive(Debug, Clone, PartialEq)]
pub struct Compacted {
    /// The compacted rules, at most as many as were learned.
    pub rules: Population,
    /// The number of percepts of the maze for which the learner has values.
    pub percepts: usize,
    /// The number of these percepts in which the compacted rules choose only actions that the
    /// learner rates best.
    pub agreeing: usize,
    /// True if the compacted policy is globally optimal.
    pub optimal: bool,
}

impl Compacted {
    /// The maximum number of distinct percepts of a world for compaction; more would take minutes.
    pub const MOST_PERCEPTS: usize = 4096;

    /// Compacts learned rules. `None` for a table, for rules that depend on more than the percept, and in worlds with
    /// more than [`MOST_PERCEPTS`](Self::MOST_PERCEPTS) distinct percepts.
    pub fn new(knowledge: &Knowledge, sensor: Sensor, maze: &Maze, paths: &Paths) -> Option<Self> {
        let actions = maze.action_count();
        if knowledge.remembers() {
            return None;
        }
        let percepts = sensor.at_most_percepts(maze, Self::MOST_PERCEPTS)?;
        let values = |percept: &_| knowledge.values(percept, actions);
        let learned = knowledge.rules()?;
        let compacted = compact(learned, &sensor.layout(maze), &percepts, values);
        // The learned rules may be fewer, because induced rules vote together.
        let rules = match compacted.len() > learned.len() {
            true => learned.clone(),
            false => compacted,
        };
        let compacted = Knowledge::Rules(rules.clone());
        let known = percepts.iter().filter(|p| values(p).greatest().is_some());
        let agrees = |percept: &_| {
            let wanted = values(percept);
            let chosen = compacted.values(percept, actions);
            let is_wanted = |action| wanted.best_actions().any(|best| best == action);
            chosen.greatest().is_some() && chosen.best_actions().all(is_wanted)
        };
        let frozen = Frozen::new(compacted.clone(), actions, 1);
        let fault = FaultFinder::default().find(&frozen, sensor, maze, paths);
        Some(Self {
            percepts: known.clone().count(),
            agreeing: known.filter(|percept| agrees(percept)).count(),
            optimal: fault.is_none(),
            rules,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::{Estimator, Method};
    use crate::trial::{Plan, Trial};
    use xcs::Layout;

    #[test]
    fn compacted_rules_are_never_more_than_were_learned_and_choose_the_same() {
        let mut grown = 0;
        let trials = ["maze4", "maze5", "maze6"]
            .into_iter()
            .flat_map(|maze| (1..=12).map(move |seed| (maze, seed)));
        for (maze, seed) in trials {
            let path = format!("{}/../../worlds/{maze}.json", env!("CARGO_MANIFEST_DIR"));
            let maze = Maze::load(path.as_ref()).unwrap();
            let plan = Plan::new(maze.clone());
            let plan = plan
                .method(Method::XcscrPlus)
                .arena(xcscr_robot::arena::ArenaKind::Grid);
            let mut plan = plan.episodes(40).seed(seed);
            plan.config.settings.plus.estimator = Estimator::Percept;
            let mut trial = Trial::new(plan).unwrap();
            let _ = trial.run(&mut ());
            let knowledge = trial.method().knowledge();
            let sensor = trial.plan().config.sensor;
            let compacted = Compacted::new(&knowledge, sensor, &maze, trial.paths()).unwrap();
            let learned = knowledge.rules().unwrap();
            assert!(compacted.rules.len() <= learned.len(), "seed {seed}");
            assert_eq!(compacted.agreeing, compacted.percepts, "seed {seed}");
            let values = |percept: &_| knowledge.values(percept, maze.action_count());
            let alone = compact(learned, &Layout::default(), &sensor.percepts(&maze), values);
            grown += usize::from(alone.len() > learned.len());
        }
        assert!(
            grown > 0,
            "control: compaction alone makes some sets larger"
        );
    }
}
