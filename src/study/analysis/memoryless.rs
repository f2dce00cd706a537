//! Whether a policy without memory can be optimal.

use std::collections::{BTreeMap, BTreeSet};

use crate::sensor::Sensor;
use crate::trial::Plan;
use crate::world::{Cell, Maze, Paths};
use crate::xcs::{Action, Percept};

/// Maximum number of cells that a search visits. Beyond, nothing is said.
const MOST_VISITS: usize = 100_000;

/// Returns true if no policy that maps percepts to actions is globally optimal: cells share a percept,
/// and need different actions, whichever shortest paths the policy takes.
pub fn needs_memory(plan: &Plan) -> bool {
    let plan = plan.clone().settled();
    if plan.config.settings.sensor.history > 0 {
        // The percept has a memory.
        return false;
    }
    let (maze, sensor) = (&plan.maze, plan.config.sensor);
    let paths = Paths::with_slip(maze, plan.config.settings.arena.slip);
    if !sensor.misleads(maze, &paths) {
        return false;
    }
    let mut search = Search {
        maze,
        sensor,
        paths: &paths,
        visits: 0,
    };
    search.finds_policy(State::new(maze)) == Some(false)
}

/// A search for an optimal policy.
struct Search<'a> {
    maze: &'a Maze,
    sensor: Sensor,
    paths: &'a Paths,
    visits: usize,
}

/// A part of a policy, and the cells that it reaches.
#[derive(Clone)]
struct State {
    open: Vec<Cell>,
    seen: BTreeSet<usize>,
    policy: BTreeMap<Percept, Action>,
}

impl State {
    fn new(maze: &Maze) -> Self {
        Self {
            open: maze.starts().collect(),
            seen: BTreeSet::new(),
            policy: BTreeMap::new(),
        }
    }
}

impl Search<'_> {
    /// Returns true if the part of a policy can be completed to an optimal one, and `None` if the
    /// search takes too long.
    fn finds_policy(&mut self, mut state: State) -> Option<bool> {
        while let Some(cell) = state.open.pop() {
            if self.maze.is_goal(cell) || !state.seen.insert(self.maze.index(cell)) {
                continue;
            }
            self.visits += 1;
            if self.visits > MOST_VISITS {
                return None;
            }
            let percept = self.sensor.perceive_at(self.maze, cell);
            let chosen = state.policy.get(&percept).copied();
            let mut actions = Action::all(self.maze.action_count())
                .filter(|action| chosen.is_none_or(|chosen| chosen == *action))
                .filter_map(|action| Some((action, self.paths.successor(self.maze, cell, action)?)))
                .collect::<Vec<_>>();
            let Some(last) = actions.pop() else {
                return Some(false);
            };
            // All but the last one on a copy.
            for option in actions {
                let mut copy = state.clone();
                self.follow(&mut copy, cell, percept, option);
                match self.finds_policy(copy) {
                    Some(false) => {}
                    found => return found,
                }
            }
            self.follow(&mut state, cell, percept, last);
        }
        Some(true)
    }

    /// Chooses an action for a percept, and opens the cells that follow.
    fn follow(&self, state: &mut State, cell: Cell, percept: Percept, option: (Action, Cell)) {
        let (action, next) = option;
        state.policy.insert(percept, action);
        state.open.push(next);
        if self.paths.slips() {
            let directions = self.maze.moves().directions().iter();
            let slipped = directions.filter_map(|&along| self.maze.step(cell, along));
            state.open.extend(slipped);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn needs(corridor: &str, sensor: Sensor) -> bool {
        let wall = "#".repeat(corridor.len());
        let world = serde_json::json!({ "rows": [wall, corridor, wall] }).to_string();
        let maze = Maze::from_json(world.as_bytes(), "corridor").unwrap();
        needs_memory(&Plan::new(maze).sensor(sensor))
    }

    #[test]
    fn a_corridor_with_the_goal_in_the_middle_and_starts_on_both_sides_needs_memory() {
        let both_sides = "#...G...#";
        assert!(needs(both_sides, Sensor::Neighbours));
        assert!(!needs(both_sides, Sensor::NeighboursPosition), "control");
        assert!(!needs("#S.....G#", Sensor::Neighbours), "control");
    }

    #[test]
    fn an_aliased_cell_that_another_shortest_path_avoids_needs_none() {
        for name in ["maze4", "maze5", "maze6"] {
            let maze = Maze::from_json(crate::world::bundled_world(name).unwrap().as_bytes(), name);
            let plan = Plan::new(maze.unwrap()).sensor(Sensor::Neighbours);
            assert!(!needs_memory(&plan), "{name}");
        }
    }
}
