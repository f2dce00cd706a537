//! The greedy policy, and whether it is globally optimal.

use std::collections::BTreeMap;

use crate::agent::Agent;
use xcs::PredictionArray;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, Maze, Paths};

/// The value of each action in each free cell of a maze, in reading order of the cells; in a
/// [vast](Maze::is_vast) maze only in those on the way that the policy takes from a fixed start.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyMap {
    cells: Vec<(Cell, PredictionArray)>,
}

impl PolicyMap {
    /// Asks a learner what it would do in each free cell that is no goal. Changes nothing.
    pub fn of(method: &dyn Agent, sensor: Sensor, maze: &Maze) -> Self {
        let values = |cell| (cell, method.values(&sensor.perceive_at(maze, cell)));
        if maze.is_vast() {
            return Self::along_the_way(maze, values);
        }
        let cells = maze.free_cells().filter(|&cell| !maze.is_goal(cell));
        Self {
            cells: cells.map(values).collect(),
        }
    }

    /// Each free cell that is no goal, with the value of its actions.
    pub fn cells(&self) -> impl Iterator<Item = &(Cell, PredictionArray)> {
        self.cells.iter()
    }

    /// The value of the actions in a cell; `None` for walls and goals.
    pub fn values(&self, cell: Cell) -> Option<&PredictionArray> {
        let at = self
            .cells
            .binary_search_by_key(&(cell.row, cell.col), |(c, _)| (c.row, c.col));
        at.ok().map(|i| &self.cells[i].1)
    }

    /// How the greatest value of each cell compares with that of all others, from 0 (the least) to
    /// 1 (the greatest), in the order of [`cells`](Self::cells); equal value has equal ranks, `None`
    /// is for cells that know none.
    pub fn ranks(&self) -> Vec<Option<f64>> {
        let greatest = self.cells.iter().map(|(_, values)| values.greatest());
        let mut known: Vec<f64> = greatest.clone().flatten().collect();
        known.sort_by(f64::total_cmp);
        known.dedup();
        let last = known.len().saturating_sub(1).max(1) as f64;
        let rank = |values: f64| known.partition_point(|&other| other < values) as f64 / last;
        greatest.map(|values| values.map(rank)).collect()
    }

    /// How near the goal each cell is along the greedy policy, the first of the best actions on ties: from 0 (the most
    /// steps of all cells) to 1 (one step), in the order of [`cells`](Self::cells); `None` where the policy does not
    /// arrive. Along a greedy path it only grows.
    pub fn nearness(&self, maze: &Maze) -> Vec<Option<f64>> {
        let steps = self.steps_to_goal(maze);
        let most = steps.iter().flatten().max().copied().unwrap_or(1);
        let share = |steps: u32| f64::from(most - steps) / f64::from(most.max(2) - 1);
        steps.into_iter().map(|steps| steps.map(share)).collect()
    }

    /// The steps to a goal from each cell along the greedy policy.
    fn steps_to_goal(&self, maze: &Maze) -> Vec<Option<u32>> {
        let mut before: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        let mut arrived = Vec::new();
        for (at, (cell, values)) in self.cells.iter().enumerate() {
            match ahead(maze, *cell, values) {
                Some(next) if maze.is_goal(next) => arrived.push(at),
                Some(next) => before.entry(maze.index(next)).or_default().push(at),
                None => {}
            }
        }
        let mut steps = vec![None; self.cells.len()];
        let mut number = 1;
        while !arrived.is_empty() {
            let here = std::mem::take(&mut arrived);
            for at in here {
                steps[at] = Some(number);
                let from = before.remove(&maze.index(self.cells[at].0));
                arrived.extend(from.into_iter().flatten());
            }
            number += 1;
        }
        steps
    }

    fn along_the_way(maze: &Maze, values: impl Fn(Cell) -> (Cell, PredictionArray)) -> Self {
        let mut cells = BTreeMap::new();
        let mut at = maze.start();
        while let Some(cell) = at.filter(|&cell| !maze.is_goal(cell)) {
            let here = values(cell);
            at = ahead(maze, cell, &here.1);
            if cells.insert((cell.row, cell.col), here).is_some() {
                break;
            }
        }
        Self {
            cells: cells.into_values().collect(),
        }
    }

    /// The cells through which the greedy policy goes from `start`, the first of the best actions
    /// on ties: to a goal, or until it hits a wall, knows no action, or has taken as many steps as
    /// there are cells.
    pub fn greedy_path(&self, maze: &Maze, start: Cell) -> Vec<Cell> {
        let mut path = vec![start];
        let mut cell = start;
        while path.len() <= self.cells.len() && !maze.is_goal(cell) {
            let values = self.values(cell);
            let Some(next) = values.and_then(|values| ahead(maze, cell, values)) else {
                break;
            };
            path.push(next);
            cell = next;
        }
        path
    }
}

/// Where the first of the best actions leads.
fn ahead(maze: &Maze, cell: Cell, values: &PredictionArray) -> Option<Cell> {
    let action = values.best_actions().next()?;
    maze.step(cell, maze.direction(action)?)
}

/// Looks, episode after episode, whether a greedy policy is globally optimal: from every start
/// cell, every action that attains the greatest value (all of them, on ties) must move along a
/// shortest path to a goal. Its memory spares work in proportion to the maze.
#[derive(Debug, Clone, Default)]
pub struct FaultFinder {
    /// By cell index: the last search that came there.
    seen: Vec<u32>,
    /// The number of this search.
    search: u32,
    /// Cells that one gets to, and that were not looked at yet.
    open: Vec<Cell>,
    /// Where a fault was before.
    suspect: Option<Cell>,
}

impl FaultFinder {
    /// A cell in which the policy is not globally optimal; `None` when it is. Asks the learner
    /// about no more cells than it takes to find the first fault, beginning where one was before.
    /// The maze must be the same each time.
    pub fn find(
        &mut self,
        method: &dyn Agent,
        sensor: Sensor,
        maze: &Maze,
        paths: &Paths,
    ) -> Option<Cell> {
        self.begin(maze);
        // Of several start cells any may come first; a single one must.
        let suspect = self.suspect.filter(|_| maze.start().is_none());
        let mut starts = suspect.into_iter().chain(maze.starts().rev());
        while let Some(cell) = self.open.pop().or_else(|| starts.next()) {
            if maze.is_goal(cell) || self.was_seen(maze.index(cell)) {
                continue;
            }
            let values = method.values(&sensor.perceive_at(maze, cell));
            let nexts = values
                .best_actions()
                .map(|action| paths.successor(maze, cell, action));
            let before = self.open.len();
            self.open.extend(nexts.clone().map_while(|next| next));
            let is_sound = values.greatest().is_some() && nexts.count() == self.open.len() - before;
            if !is_sound {
                self.suspect = Some(cell);
                return self.suspect;
            }
            if paths.slips() {
                let around = maze.moves().directions().iter();
                let slipped = around.filter_map(|&along| maze.step(cell, along));
                self.open.extend(slipped);
            }
        }
        self.suspect = None;
        None
    }

    fn begin(&mut self, maze: &Maze) {
        if self.seen.is_empty() {
            // Zeroed memory costs nothing before it is used.
            self.seen = vec![0; usize::from(maze.width()) * usize::from(maze.height())];
        }
        if self.search == u32::MAX {
            self.seen.fill(0);
            self.search = 0;
        }
        self.search += 1;
        self.open.clear();
    }

    fn was_seen(&mut self, at: usize) -> bool {
        std::mem::replace(&mut self.seen[at], self.search) == self.search
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcs::Action;

    /// A corridor of six cells with the goal in the east. All cells go east but the second, which goes west; the values are
    /// in no order.
    fn policy() -> (Maze, PolicyMap) {
        let rows = ["########", "#.....G#", "########"];
        let world = format!(r#"{{ "rows": {rows:?} }}"#);
        let maze = Maze::from_json(world.as_bytes(), "corridor.json").unwrap();
        let (east, west) = (Action::new(1).unwrap(), Action::new(3).unwrap());
        let choices = [
            (east, 5.0),
            (west, 9.0),
            (east, 2.0),
            (east, 7.0),
            (east, 1.0),
        ];
        let cells = (1..).zip(choices).map(|(col, (action, value))| {
            let mut values = PredictionArray::new(4);
            values.set(action, value);
            (Cell { col, row: 1 }, values)
        });
        let cells = cells.collect();
        (maze, PolicyMap { cells })
    }

    #[test]
    fn nearness_grows_along_the_policy_and_is_unknown_where_it_does_not_arrive() {
        let (maze, policy) = policy();
        let near = policy.nearness(&maze);
        assert_eq!(near, [None, None, Some(0.0), Some(0.5), Some(1.0)]);
        let ranks: Vec<f64> = policy.ranks().into_iter().flatten().collect();
        assert!(
            !ranks[2..].is_sorted(),
            "control: the values are in no order"
        );
    }
}
