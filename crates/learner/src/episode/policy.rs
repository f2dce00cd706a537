//! The greedy policy, and its global optimality.

use std::collections::{BTreeMap, BTreeSet};

use crate::agent::Agent;
use xcs::PredictionArray;
use xcscr_robot::sensor::{History, Sensor};
use xcscr_robot::world::{Cell, Maze, Paths};

/// The value of each action in each free cell of a maze, in reading order of the cells. In a
/// [very large](Maze::is_too_large) maze, only cells on the greedy path from a fixed start are included.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyMap {
    cells: Vec<(Cell, PredictionArray)>,
}

impl PolicyMap {
    /// Evaluates a learner in each free cell that is not a goal, without changing the learner. A learner with a history
    /// is evaluated at the beginning of an episode and, in the cells of the greedy path from a fixed start, on that path.
    pub fn of(method: &dyn Agent, sensor: Sensor, maze: &Maze) -> Self {
        let beginning = method.first_history();
        let values = |cell| {
            let percept = beginning.behind(&sensor.perceive_at(maze, cell));
            (cell, method.values(&percept))
        };
        if maze.is_too_large() {
            let cells = on_path(method, sensor, maze).into_values().collect();
            return Self { cells };
        }
        let cells = maze.free_cells().filter(|&cell| !maze.is_goal(cell));
        let mut map = Self {
            cells: cells.map(values).collect(),
        };
        if beginning.keeps_steps() {
            for (cell, values) in on_path(method, sensor, maze).into_values() {
                if let Ok(place) = map.place(cell) {
                    map.cells[place].1 = values;
                }
            }
        }
        map
    }

    /// Returns the cells with the values of their actions.
    pub fn cells(&self) -> impl Iterator<Item = &(Cell, PredictionArray)> {
        self.cells.iter()
    }

    /// Returns the values of the actions in a cell; `None` for walls and goals.
    pub fn values(&self, cell: Cell) -> Option<&PredictionArray> {
        self.place(cell).ok().map(|place| &self.cells[place].1)
    }

    /// Returns the place of a cell in the list.
    fn place(&self, cell: Cell) -> Result<usize, usize> {
        let key = |(cell, _): &(Cell, PredictionArray)| (cell.row, cell.col);
        self.cells.binary_search_by_key(&(cell.row, cell.col), key)
    }

    /// Ranks the greatest value of each cell among all cells, from 0 (the least) to 1 (the
    /// greatest), in the order of [`cells`](Self::cells). Equal values have equal ranks; cells
    /// without values have `None`.
    pub fn ranks(&self) -> Vec<Option<f64>> {
        let greatest = self.cells.iter().map(|(_, values)| values.greatest());
        let mut known: Vec<f64> = greatest.clone().flatten().collect();
        known.sort_by(f64::total_cmp);
        known.dedup();
        let last = known.len().saturating_sub(1).max(1) as f64;
        let rank = |values: f64| known.partition_point(|&other| other < values) as f64 / last;
        greatest.map(|values| values.map(rank)).collect()
    }

    /// Returns how near each cell is to the goal along the greedy policy: from 0 (the most steps of all cells) to 1
    /// (one step), in the order of [`cells`](Self::cells). Ties are broken by the first best action. `None` if the
    /// policy does not reach a goal. Nearness grows along a greedy path.
    pub fn nearness(&self, maze: &Maze) -> Vec<Option<f64>> {
        let steps = self.steps_to_goal(maze);
        let most = steps.iter().flatten().max().copied().unwrap_or(1);
        let share = |steps: u32| f64::from(most - steps) / f64::from(most.max(2) - 1);
        steps.into_iter().map(|steps| steps.map(share)).collect()
    }

    /// Returns the steps to a goal from each cell along the greedy policy.
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

    /// Returns the cells of the [greedy path](greedy_path) from `start`, with ties broken by the first best action.
    pub fn greedy_path(&self, maze: &Maze, start: Cell) -> Vec<Cell> {
        greedy_path(start, |cell| ahead(maze, cell, self.values(cell)?))
    }
}

/// Returns the cells of a path from `start`, where `ahead` returns the cell after each one: up to a goal, a wall or a
/// cell without values, which have none, or to the first repeated cell.
pub fn greedy_path(start: Cell, ahead: impl Fn(Cell) -> Option<Cell>) -> Vec<Cell> {
    let (mut path, mut seen) = (Vec::new(), BTreeSet::new());
    let mut at = Some(start);
    while let Some(cell) = at.filter(|cell| seen.insert((cell.row, cell.col))) {
        path.push(cell);
        at = ahead(cell);
    }
    path
}

/// Evaluates a learner in each cell of its greedy path from a fixed start, with the history of the path. By row and column.
fn on_path(
    method: &dyn Agent,
    sensor: Sensor,
    maze: &Maze,
) -> BTreeMap<(u16, u16), (Cell, PredictionArray)> {
    let mut history = method.first_history();
    let mut found = BTreeMap::new();
    let mut at = maze.start();
    while let Some(cell) = at.filter(|&cell| !maze.is_goal(cell)) {
        let percept = sensor.perceive_at(maze, cell);
        let values = method.values(&history.behind(&percept));
        at = ahead(maze, cell, &values);
        if let Some(action) = values.best_actions().next() {
            history = history.after(&percept, action);
        }
        if found.contains_key(&(cell.row, cell.col)) {
            break;
        }
        found.insert((cell.row, cell.col), (cell, values));
    }
    found
}

/// Returns the cell that the first best action leads to.
fn ahead(maze: &Maze, cell: Cell, values: &PredictionArray) -> Option<Cell> {
    let action = values.best_actions().next()?;
    maze.step(cell, maze.direction(action)?)
}

/// Checks repeatedly whether a greedy policy is globally optimal: from every start cell, every best
/// action (all of them, on ties) must move along a shortest path to a goal. Memory is reused
/// between searches.
#[derive(Debug, Clone, Default)]
pub struct FaultFinder {
    /// By cell index: the last search that visited the cell.
    seen: Vec<u32>,
    /// The number of the present search.
    search: u32,
    /// Reached cells that are not checked yet.
    open: Vec<Cell>,
    /// The cell of the last fault.
    suspect: Option<Cell>,
}

impl FaultFinder {
    /// Returns a cell in which the policy is not globally optimal; `None` if it is optimal. The
    /// search stops at the first fault, and begins where the last fault was. The maze must be the
    /// same each time.
    pub fn find(
        &mut self,
        method: &dyn Agent,
        sensor: Sensor,
        maze: &Maze,
        paths: &Paths,
    ) -> Option<Cell> {
        if method.first_history().keeps_steps() {
            return fault_with_history(method, sensor, maze, paths);
        }
        self.begin(maze);
        // Several start cells can be checked in any order; a single one must come first.
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
            let is_valid = values.greatest().is_some() && nexts.count() == self.open.len() - before;
            if !is_valid {
                self.suspect = Some(cell);
                return self.suspect;
            }
            if paths.slips() {
                let directions = maze.moves().directions().iter();
                let slipped = directions.filter_map(|&along| maze.step(cell, along));
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

/// Returns a cell in which the policy of a learner with a history is not globally optimal, from any start. Each pair of
/// a cell and a history that the policy can reach is checked.
fn fault_with_history(
    method: &dyn Agent,
    sensor: Sensor,
    maze: &Maze,
    paths: &Paths,
) -> Option<Cell> {
    let beginning = method.first_history();
    let mut open: Vec<(Cell, History)> = maze.starts().map(|cell| (cell, beginning)).collect();
    let mut seen = BTreeSet::new();
    while let Some((cell, history)) = open.pop() {
        if maze.is_goal(cell) || !seen.insert((maze.index(cell), history)) {
            continue;
        }
        let percept = sensor.perceive_at(maze, cell);
        let values = method.values(&history.behind(&percept));
        if values.greatest().is_none() {
            return Some(cell);
        }
        for action in values.best_actions() {
            let Some(next) = paths.successor(maze, cell, action) else {
                return Some(cell);
            };
            let history = history.after(&percept, action);
            open.push((next, history));
            if paths.slips() {
                let directions = maze.moves().directions().iter();
                let slipped = directions.filter_map(|&along| maze.step(cell, along));
                open.extend(slipped.chain([cell]).map(|cell| (cell, history)));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcs::Action;

    /// A corridor of six cells with the goal in the east. All cells go east except the second, which goes west. The
    /// values are not sorted.
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

    #[test]
    fn in_a_maze_too_large_to_be_shown_the_path_has_its_history() {
        let side = 400;
        let mut rows = vec!["#".repeat(side); side];
        rows[1].replace_range(1..6, "S...G");
        let world = format!(r#"{{ "rows": {rows:?} }}"#);
        let maze = Maze::from_json(world.as_bytes(), "large.json").unwrap();
        assert!(maze.is_too_large(), "control");
        let config = crate::trial::Config {
            sensor: Sensor::Neighbours,
            ..Default::default()
        };
        let met = |history: u32| {
            let mut config = config.clone();
            config.settings.sensor.history = history;
            // By percept with its history: the action that leads on, known on the path only.
            let mut past = History::new(config.perception(), &maze);
            let east = Action::new(1).unwrap();
            let table = (1..5).map(|col| {
                let here = Sensor::Neighbours.perceive_at(&maze, Cell { col, row: 1 });
                let percept = past.behind(&here);
                past = past.after(&here, east);
                (percept, vec![None, Some(1.0)])
            });
            let knowledge = crate::agent::Knowledge::Table(table.collect());
            let policy = config.policy(knowledge, &maze);
            PolicyMap::of(&*policy, Sensor::Neighbours, &maze)
                .cells
                .len()
        };
        assert_eq!([0, 1].map(met), [4, 4]);
    }
}
