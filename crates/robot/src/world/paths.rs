//! Shortest paths from every cell to the nearest goal.

use std::sync::Arc;

use super::action_slip::Expected;
use super::maze::{Cell, Maze};
use xcs::Action;

/// Marker in place of a distance: the cell is free, but cannot reach a goal.
const CUT_OFF: u32 = u32::MAX;
/// Marker in place of a distance: the cell is a wall. A single look-up then gives everything about
/// a cell, which matters in mazes larger than the cache.
const WALL: u32 = u32::MAX - 1;

/// The length of the shortest path from each cell to the nearest goal. For slipping actions, where
/// shortest paths are not optimal, also the expected numbers of steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Paths {
    /// By cell index: the distance, or [`CUT_OFF`] or [`WALL`].
    distance: Arc<[u32]>,
    /// `None` if actions do not slip.
    expected: Option<Expected>,
}

impl Paths {
    /// Finds the shortest paths of a maze. The search runs once for a maze and its clones.
    pub fn new(maze: &Maze) -> Self {
        Self {
            distance: maze.cache.distances(|| search(maze)),
            expected: None,
        }
    }

    /// Finds the shortest paths for actions that slip with probability `slip`. The best actions are
    /// then those of value iteration.
    pub fn with_slip(maze: &Maze, slip: f64) -> Self {
        let mut paths = Self::new(maze);
        if slip > 0.0 {
            let mut cells: Vec<Cell> = maze.cells().collect();
            cells.retain(|&cell| paths.distance(maze, cell).is_some());
            cells.sort_by_key(|&cell| paths.distance(maze, cell));
            paths.expected = Some(Expected::new(maze, &cells, slip));
        }
        paths
    }

    /// Returns true if actions can slip.
    pub fn slips(&self) -> bool {
        self.expected.is_some()
    }

    /// Returns the expected number of steps to a goal under an optimal policy; `None` for walls and
    /// cells that cannot reach a goal.
    pub fn expected_steps(&self, maze: &Maze, cell: Cell) -> Option<f64> {
        let distance = self.distance(maze, cell)?;
        let expected = self.expected.as_ref();
        Some(expected.map_or(f64::from(distance), |expected| expected.from(maze, cell)))
    }

    /// Returns the steps from a cell to the nearest goal; `None` for walls and cells that cannot
    /// reach a goal.
    pub fn distance(&self, maze: &Maze, cell: Cell) -> Option<u32> {
        if cell.col >= maze.width() || cell.row >= maze.height() {
            return None;
        }
        Some(self.distance[maze.index(cell)]).filter(|&steps| steps < WALL)
    }

    /// Returns the length of the longest shortest path from a cell in which an episode can start.
    pub fn longest(&self, maze: &Maze) -> u32 {
        match maze.start() {
            Some(start) => self.distance(maze, start).unwrap_or(0),
            None => {
                let known = self.distance.iter().filter(|&&steps| steps < WALL);
                known.copied().max().unwrap_or(0)
            }
        }
    }

    /// Returns the cells on shortest paths from where an episode can start, in reading order,
    /// including goals. With a random start these are all cells that can reach a goal. With slip
    /// they are all cells that can be reached from the start.
    pub fn cells_on_shortest<'a>(&'a self, maze: &'a Maze) -> impl Iterator<Item = Cell> + 'a {
        let ahead = maze.start().map(|start| self.ahead_of(maze, start));
        maze.cells().filter(move |&cell| {
            let at = maze.index(cell);
            ahead
                .as_ref()
                .map_or(self.distance[at] < WALL, |ahead| ahead[at])
        })
    }

    /// Returns, by cell index, whether the cell is on a shortest path from `start`; with slip,
    /// whether it is on any path.
    fn ahead_of(&self, maze: &Maze, start: Cell) -> Vec<bool> {
        let mut ahead = vec![false; self.distance.len()];
        let mut open = vec![start];
        while let Some(cell) = open.pop() {
            if std::mem::replace(&mut ahead[maze.index(cell)], true) {
                continue;
            }
            let actions = Action::all(maze.action_count());
            open.extend(actions.filter_map(|action| match self.slips() {
                true => maze.step(cell, maze.direction(action)?),
                false => self.successor(maze, cell, action),
            }));
        }
        ahead
    }

    /// Returns the cell that an action leads to, if the step is on a shortest path. With slip, if
    /// it is a best action.
    pub fn successor(&self, maze: &Maze, cell: Cell, action: Action) -> Option<Cell> {
        if let Some(expected) = &self.expected {
            self.distance(maze, cell)?;
            let along = maze.direction(action)?;
            let next = maze.step(cell, along).unwrap_or(cell);
            return expected.is_best(maze, cell, along).then_some(next);
        }
        let next = maze.step(cell, maze.direction(action)?)?;
        let nearer = self.distance(maze, next)? + 1 == self.distance(maze, cell)?;
        nearer.then_some(next)
    }

    /// Returns the number of different shortest paths from a cell to a goal, capped at `u64::MAX`.
    pub fn count_from(&self, maze: &Maze, start: Cell) -> u64 {
        let Some(distance) = self.distance(maze, start) else {
            return 0;
        };
        // For each cell: the number of paths from the start.
        let mut ways = vec![(start, 1_u64)];
        for left in (0..distance).rev() {
            ways = self.ways_onward(maze, &ways, left);
        }
        ways.iter().fold(0, |sum, way| sum.saturating_add(way.1))
    }

    /// Returns the path counts of the cells `left` steps from a goal, from those one step before.
    fn ways_onward(&self, maze: &Maze, ways: &[(Cell, u64)], left: u32) -> Vec<(Cell, u64)> {
        let directions = maze.moves().directions().iter();
        // One direction after the other, so that the list consists of few ascending runs.
        let mut onward: Vec<(Cell, u64)> = directions
            .flat_map(|&direction| {
                ways.iter().filter_map(move |&(cell, count)| {
                    let next = maze.step(cell, direction)?;
                    (self.distance[maze.index(next)] == left).then_some((next, count))
                })
            })
            .collect();
        onward.sort_by_key(|way| (way.0.row, way.0.col));
        onward.dedup_by(|later, kept| {
            let same = later.0 == kept.0;
            if same {
                kept.1 = kept.1.saturating_add(later.1);
            }
            same
        });
        onward
    }
}

/// Runs a breadth-first search from the goals outward (moves can be reversed in every world).
fn search(maze: &Maze) -> Vec<u32> {
    let blank = |&wall: &bool| if wall { WALL } else { CUT_OFF };
    let mut distance: Vec<u32> = maze.walls.iter().map(blank).collect();
    let mut near: Vec<Cell> = maze.goals().to_vec();
    near.iter().for_each(|&goal| distance[maze.index(goal)] = 0);
    for beyond in 1.. {
        let mut far = Vec::new();
        for &cell in &near {
            for &direction in maze.moves().directions() {
                let Some(next) = maze.step(cell, direction) else {
                    continue;
                };
                let known = &mut distance[maze.index(next)];
                if *known == CUT_OFF {
                    *known = beyond;
                    far.push(next);
                }
            }
        }
        if far.is_empty() {
            break;
        }
        near = far;
    }
    distance
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    const ROWS: [&str; 6] = [
        "########", "#S.#...#", "#..#.#.#", "#.##.#.#", "#....#G#", "########",
    ];

    fn maze() -> Maze {
        Maze::from_json(format!(r#"{{ "rows": {ROWS:?} }}"#).as_bytes(), "m").unwrap()
    }

    /// Independent of value iteration: solves a linear system for the steps of a policy.
    fn steps_of(maze: &Maze, cells: &[Cell], slip: f64, policy: &[Action]) -> DVector<f64> {
        let mut matrix = DMatrix::identity(cells.len(), cells.len());
        let others = maze.action_count() as f64 - 1.0;
        for (row, &cell) in cells.iter().enumerate() {
            for action in Action::all(maze.action_count()) {
                let along = maze.direction(action).unwrap();
                let next = maze.step(cell, along).unwrap_or(cell);
                let chance = if action == policy[row] {
                    1.0 - slip
                } else {
                    slip / others
                };
                if let Some(column) = cells.iter().position(|&c| c == next) {
                    matrix[(row, column)] -= chance;
                }
            }
        }
        matrix
            .lu()
            .solve(&DVector::repeat(cells.len(), 1.0))
            .unwrap()
    }

    #[test]
    fn value_iteration_agrees_with_linear_equations() {
        let maze = maze();
        let cells: Vec<Cell> = maze.free_cells().filter(|&c| !maze.is_goal(c)).collect();
        for slip in [0.05, 0.1, 0.25, 0.5] {
            let paths = Paths::with_slip(&maze, slip);
            let best = |&cell: &Cell| {
                let mut actions = Action::all(maze.action_count());
                actions
                    .find(|&a| paths.successor(&maze, cell, a).is_some())
                    .unwrap()
            };
            let policy: Vec<Action> = cells.iter().map(best).collect();
            let solved = steps_of(&maze, &cells, slip, &policy);
            for (row, &cell) in cells.iter().enumerate() {
                let iterated = paths.expected_steps(&maze, cell).unwrap();
                let apart = (iterated - solved[row]).abs() / solved[row];
                assert!(
                    apart < 1e-8,
                    "slip {slip}, {cell:?}: {iterated} {}",
                    solved[row]
                );
            }
            // No change of a single action improves the policy.
            for row in 0..cells.len() {
                for action in Action::all(maze.action_count()) {
                    let mut other = policy.clone();
                    other[row] = action;
                    let changed = steps_of(&maze, &cells, slip, &other)[row];
                    assert!(
                        changed > solved[row] * (1.0 - 1e-8),
                        "slip {slip}, {:?}",
                        cells[row]
                    );
                }
            }
        }
    }

    #[test]
    fn without_slip_a_best_action_follows_a_shortest_path() {
        let (maze, paths) = (maze(), Paths::new(&maze()));
        assert_eq!(Paths::with_slip(&maze, 0.0), paths);
        let start = maze.start_cells()[0];
        assert_eq!(paths.expected_steps(&maze, start), Some(14.0));
        let slippery = Paths::with_slip(&maze, 0.1);
        assert!(slippery.slips() && slippery.expected_steps(&maze, start).unwrap() > 15.0);
    }
}
