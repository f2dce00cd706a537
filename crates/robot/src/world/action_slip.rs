//! The optimum for slipping actions: value iteration on the true maze.

use super::direction::Direction;
use super::maze::{Cell, Maze};

/// The relative difference below which two expected numbers of steps are equal.
const SAME: f64 = 1e-9;
/// The largest number of sweeps. With little slip, the number of sweeps needed is the length of the
/// longest shortest path.
const MOST_SWEEPS: usize = 100_000;

/// Returns the probability of each other action when a move slips with probability `slip`: an action
/// other than the chosen one is executed, each equally likely. This is the meaning of `arena.slip`.
pub fn each_other(slip: f64, actions: usize) -> f64 {
    slip / actions.saturating_sub(1).max(1) as f64
}

/// The expected number of steps to a goal from each cell under an optimal policy.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Expected {
    slip: f64,
    /// By cell index; infinite for walls and for cells that reach no goal.
    steps: Vec<f64>,
}

impl Expected {
    /// Runs value iteration (Bellman 1957), in place and in order of distance from the goals.
    /// `cells` are the cells that can reach a goal, nearest first.
    pub fn new(maze: &Maze, cells: &[Cell], slip: f64) -> Self {
        let mut steps = vec![f64::INFINITY; usize::from(maze.width()) * usize::from(maze.height())];
        cells.iter().for_each(|&cell| steps[maze.index(cell)] = 0.0);
        let mut expected = Self { slip, steps };
        for _ in 0..MOST_SWEEPS {
            let mut change = 0.0_f64;
            for &cell in cells.iter().filter(|&&cell| !maze.is_goal(cell)) {
                let best = directions(maze).map(|along| expected.of(maze, cell, along));
                let best = best.fold(f64::INFINITY, f64::min);
                let known = &mut expected.steps[maze.index(cell)];
                change = change.max((best - *known).abs() / best);
                *known = best;
            }
            if change < SAME / 1_000.0 {
                break;
            }
        }
        expected
    }

    /// Returns the expected steps from a cell.
    pub fn from(&self, maze: &Maze, cell: Cell) -> f64 {
        self.steps[maze.index(cell)]
    }

    /// Returns true if the direction `along` is optimal. Several directions may be.
    pub fn is_best(&self, maze: &Maze, cell: Cell, along: Direction) -> bool {
        self.of(maze, cell, along) <= self.from(maze, cell) * (1.0 + SAME)
    }

    /// Returns the expected steps when the first choice is the direction `along`. When the action
    /// slips, all other directions are equally likely.
    fn of(&self, maze: &Maze, cell: Cell, along: Direction) -> f64 {
        let each = each_other(self.slip, maze.action_count());
        let after = |way: Direction| {
            let next = maze.step(cell, way).unwrap_or(cell);
            self.steps[maze.index(next)]
        };
        let chance = |way: Direction| match way == along {
            true => 1.0 - self.slip,
            false => each,
        };
        1.0 + directions(maze)
            .map(|way| chance(way) * after(way))
            .sum::<f64>()
    }
}

fn directions(maze: &Maze) -> impl Iterator<Item = Direction> + '_ {
    maze.moves().directions().iter().copied()
}
