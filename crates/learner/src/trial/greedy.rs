//! Mean steps of the greedy policy from all starts.

use serde::{Deserialize, Serialize};

use super::bounds::Bounds;
use super::evaluation::GreedySums;
use super::plan::Plan;
use crate::agent::Knowledge;
use xcscr_robot::arena::GridArena;
use xcscr_robot::world::{Cell, Maze, Starts};

/// The number of episodes for a mean if moves slip or percepts have observation errors.
const RUNS: usize = 500;
/// The maximum number of starts from which episodes are run. More would take longer than the trial.
const MOST_STARTS: usize = 1_000;

/// Steps of the greedy policy without learning, measured on the grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GreedySteps {
    /// Mean steps over all starts, or over a thousand evenly spread starts if there are more. An episode that reaches
    /// the step-threshold counts with the step-threshold. If moves slip or percepts have observation errors, the mean
    /// is over at least 500 episodes, the same number from each start.
    pub mean: f64,
    /// Episodes that reached a goal.
    pub arrivals: u32,
    /// All episodes.
    pub episodes: u32,
}

impl GreedySteps {
    /// Runs the greedy policy of `knowledge` from the starts. The plan must have been checked, and the knowledge must
    /// fit its world. Ties are broken at random.
    pub fn of(plan: &Plan, knowledge: &Knowledge) -> Self {
        let Plan { maze, config } = plan;
        let grid = Box::new(GridArena::new(maze.clone()));
        let mut arena = config.decorated(grid, maze);
        let starts = spread(&Starts::new(maze), maze);
        let (arena_params, sensor) = (&config.settings.arena, &config.settings.sensor);
        let rounds = match arena_params.slip > 0.0 || sensor.flip_probability > 0.0 {
            true => RUNS.div_ceil(starts.len()),
            false => 1,
        };
        let starts = (0..rounds).flat_map(|_| starts.iter().copied());
        let sums = GreedySums::over(starts, plan, &mut *arena, knowledge, &mut ());
        Self {
            mean: sums.steps as f64 / f64::from(sums.episodes.max(1)),
            arrivals: sums.successes,
            episodes: sums.episodes,
        }
    }

    /// Returns the ratio of the mean steps to the unknown-start optimum. `None` if moves slip,
    /// because the optimum is then not known, or if it is
    /// unknown.
    pub fn ratio(&self, plan: &Plan) -> Option<f64> {
        let Plan { maze, config } = plan;
        let exact = config.settings.arena.slip == 0.0;
        let bound = exact
            .then(|| Bounds::unknown_start(maze, config.sensor))
            .flatten()?;
        Some(self.mean / bound)
    }
}

/// Returns all starts, or evenly spread ones.
fn spread(starts: &Starts, maze: &Maze) -> Vec<Cell> {
    let count = starts.count();
    let taken = count.min(MOST_STARTS);
    let numbers = (0..taken).map(|number| number * count / taken);
    numbers
        .filter_map(|number| starts.nth(maze, number))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_starts_are_taken_of_a_small_world_and_a_thousand_of_a_large_one() {
        let side = 40;
        let open = format!("#{}#", ".".repeat(side));
        let wall = "#".repeat(side + 2);
        for (rows, taken) in [(20, 20 * side - 1), (30, MOST_STARTS)] {
            let mut rows = vec![open.clone(); rows];
            rows[0].replace_range(1..2, "G");
            let rows = [vec![wall.clone()], rows, vec![wall.clone()]].concat();
            let text = format!(r#"{{"rows": {rows:?}}}"#);
            let maze = Maze::from_json(text.as_bytes(), "open.json").unwrap();
            let cells = spread(&Starts::new(&maze), &maze);
            assert_eq!(cells.len(), taken);
            if taken < MOST_STARTS {
                assert_eq!(cells, maze.start_cells());
            }
            assert!(cells.windows(2).all(|pair| pair[0].row <= pair[1].row));
            assert_eq!(usize::from(cells[taken - 1].row), rows.len() - 2);
        }
    }
}
