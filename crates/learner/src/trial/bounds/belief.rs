//! The unknown-start optimum without slips: dynamic programming over sets of cells (LAO*; Hansen
//! and Zilberstein 2001). A cell is in a set once for each start from which the robot would now be
//! there, so the sets are beliefs.

use std::collections::{BTreeMap, BTreeSet};

use xcs::Action;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, Maze};

/// States in ascending order, with equal percepts. A state can occur several times.
type Set = Vec<u32>;

/// The maximum work: states times actions in all sets that are evaluated. More would take
/// noticeably long.
const MOST_MOVES: usize = 10_000_000;
/// The maximum number of states in the sets with stored costs.
const MOST_STORED: usize = 2_000_000;

/// The successor of a state at a goal.
const GOAL: u32 = u32::MAX;

/// The true world: its states are the free cells that are not goals.
pub struct KnownWorld {
    actions: usize,
    /// By state: a number that is equal for equal percepts.
    percepts: Vec<u32>,
    /// By state and action: the next state, or [`GOAL`].
    next: Vec<u32>,
    starts: Set,
    /// By state: its cost under full observability, a lower bound of its cost.
    full: Vec<f64>,
}

impl KnownWorld {
    /// Creates the world of these cells, in reading order. `full` are their costs if the cell is always known.
    pub fn new(maze: &Maze, sensor: Sensor, cells: &[Cell], full: Vec<f64>) -> Self {
        let place = |cell: &Cell| (cell.row, cell.col);
        let state = |cell: Cell| {
            let at = cells.binary_search_by_key(&place(&cell), place);
            at.expect("every free cell but the goals is a state") as u32
        };
        let mut numbers = BTreeMap::new();
        let percepts = cells.iter().map(|&cell| {
            let next = numbers.len() as u32;
            *numbers
                .entry(sensor.perceive_at(maze, cell))
                .or_insert(next)
        });
        let percepts = percepts.collect();
        let actions = maze.action_count();
        let next = |(from, action): (Cell, Action)| {
            let direction = maze.direction(action);
            match direction.and_then(|direction| maze.step(from, direction)) {
                None => state(from),
                Some(cell) if maze.is_goal(cell) => GOAL,
                Some(cell) => state(cell),
            }
        };
        let pairs = cells
            .iter()
            .flat_map(|&cell| Action::all(actions).map(move |action| (cell, action)));
        let starts = maze
            .start_cells()
            .into_iter()
            .filter(|&cell| !maze.is_goal(cell));
        Self {
            actions,
            percepts,
            next: pairs.map(next).collect(),
            starts: starts.map(state).collect(),
            full,
        }
    }

    /// Returns the mean steps over the starts; `None` if there are too many sets.
    pub fn steps(&self) -> Option<f64> {
        let firsts = self.split(self.starts.clone());
        let mut search = Search {
            world: self,
            costs: BTreeMap::new(),
            moves: 0,
            stored: 0,
        };
        loop {
            let mut visited = BTreeSet::new();
            let mut changed = false;
            for first in &firsts {
                if !visited.contains(first) {
                    changed |= search.improve(first, &mut visited)?;
                }
            }
            if !changed {
                break;
            }
        }
        let total = firsts
            .iter()
            .map(|first| search.cost(first) * first.len() as f64);
        Some(total.sum::<f64>() / self.starts.len() as f64)
    }

    fn next(&self, state: u32, action: Action) -> u32 {
        self.next[state as usize * self.actions + action.index()]
    }

    /// Groups states by percept.
    fn split(&self, mut states: Set) -> Vec<Set> {
        let percept = |state: u32| self.percepts[state as usize];
        states.sort_unstable_by_key(|&state| (percept(state), state));
        let aliased = states.chunk_by(|&a, &b| percept(a) == percept(b));
        aliased.map(<[u32]>::to_vec).collect()
    }
}

struct Search<'a> {
    world: &'a KnownWorld,
    costs: BTreeMap<Set, f64>,
    moves: usize,
    stored: usize,
}

impl Search<'_> {
    /// Returns the mean steps from the states of a set, as far as known. The value is a lower
    /// bound.
    fn cost(&self, set: &Set) -> f64 {
        self.costs.get(set).copied().unwrap_or_else(|| {
            let sum: f64 = set
                .iter()
                .map(|&state| self.world.full[state as usize])
                .sum();
            sum / set.len() as f64
        })
    }

    /// Improves the costs of all sets that the best actions lead to, last ones first. Returns true
    /// if a cost changed, and `None` if the work exceeds the limit.
    fn improve(&mut self, first: &Set, visited: &mut BTreeSet<Set>) -> Option<bool> {
        let mut changed = false;
        // An explicit stack instead of recursion, which could overflow in long corridors. Each set
        // is stored with its successors that must be improved first.
        let mut open = vec![self.visit(first, visited)?];
        while let Some((_, after)) = open.last_mut() {
            if let Some(next) = after.pop() {
                if !visited.contains(&next) {
                    let next = self.visit(&next, visited)?;
                    open.push(next);
                }
            } else if let Some((set, _)) = open.pop() {
                changed |= self.settle(set);
            }
        }
        Some(changed)
    }

    /// Visits a set and returns the sets that its best action leads to, in reverse order.
    fn visit(&mut self, set: &Set, visited: &mut BTreeSet<Set>) -> Option<(Set, Vec<Set>)> {
        visited.insert(set.clone());
        // The set is evaluated now, and again when its successors are settled.
        self.moves += 2 * set.len() * self.world.actions;
        if self.moves > MOST_MOVES || self.stored > MOST_STORED {
            return None;
        }
        let (_, mut after) = self.best(set);
        after.reverse();
        Some((set.clone(), after))
    }

    /// Stores the cost of a set; returns true if the cost changed.
    fn settle(&mut self, set: Set) -> bool {
        let (cost, _) = self.best(&set);
        let changed = (cost - self.cost(&set)).abs() > 1e-9;
        let size = set.len();
        if self.costs.insert(set, cost).is_none() {
            self.stored += size;
        }
        changed
    }

    /// Returns the least cost over the actions, and the sets that the action leads to.
    fn best(&self, set: &Set) -> (f64, Vec<Set>) {
        let after = |action: Action| {
            let next = set.iter().map(|&state| self.world.next(state, action));
            next.filter(|&next| next != GOAL).collect::<Set>()
        };
        let weighed = Action::all(self.world.actions).map(|action| {
            let sets = self.world.split(after(action));
            let sum: f64 = sets
                .iter()
                .map(|next| self.cost(next) * next.len() as f64)
                .sum();
            (1.0 + sum / set.len() as f64, sets)
        });
        let better = |best: (f64, Vec<Set>), one: (f64, Vec<Set>)| {
            if one.0 < best.0 - 1e-12 { one } else { best }
        };
        weighed.reduce(better).expect("there is an action")
    }
}
