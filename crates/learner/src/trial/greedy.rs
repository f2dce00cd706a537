//! Mean steps of the greedy policy from all starts.

use serde::{Deserialize, Serialize};

use super::bounds::Bounds;
use super::drive::Drive;
use super::evaluation::GreedySums;
use super::plan::Plan;
use crate::agent::{Frozen, Knowledge};
use xcscr_robot::arena::GridArena;
use xcscr_robot::sensor::Sensor;
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
    /// because the optimum is then only estimated (`world info --bounds --slip`), or if it is
    /// unknown.
    pub fn ratio(&self, plan: &Plan) -> Option<f64> {
        let Plan { maze, config } = plan;
        let exact = config.settings.arena.slip == 0.0;
        let bound = exact
            .then(|| Bounds::of_belief(maze, config.sensor))
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

/// The maximum number of steps followed from one start, over all branches at ties.
const MOST_FOLLOWED: u32 = 10_000;

/// Returns the mean steps of the greedy policy over all starts, with exact moves. At ties, each
/// best action counts with the same share, so the result is not random. `None` if from some start
/// the policy has no values, does not reach a goal, or branches too much.
pub(super) fn expected_steps(maze: &Maze, sensor: Sensor, policy: &Frozen) -> Option<f64> {
    let starts = maze.start_cells();
    let steps = starts
        .iter()
        .map(|&start| steps_from(maze, sensor, policy, start));
    let all: f64 = steps.sum::<Option<f64>>()?;
    Some(all / starts.len() as f64)
}

/// Like [`expected_steps`], from one start.
fn steps_from(maze: &Maze, sensor: Sensor, policy: &Frozen, start: Cell) -> Option<f64> {
    let mut steps = 0.0;
    let mut left = MOST_FOLLOWED;
    let mut open = vec![(Drive::new(policy.clone(), start), 1.0)];
    while let Some((mut drive, share)) = open.pop() {
        if maze.is_goal(drive.cell()) {
            continue;
        }
        left = left.checked_sub(1)?;
        steps += share;
        let best = drive.best_actions(maze, sensor);
        let (first, others) = best.split_first()?;
        let share = share / best.len() as f64;
        for &other in others {
            let mut drive = drive.clone();
            drive.take(maze, other);
            open.push((drive, share));
        }
        drive.take(maze, *first);
        open.push((drive, share));
    }
    Some(steps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcscr_robot::arena::ArenaKind;

    fn expected_in(plan: &Plan, knowledge: Knowledge) -> Option<f64> {
        let policy = Frozen::new(knowledge, plan.maze.action_count(), 50);
        expected_steps(&plan.maze, plan.config.sensor, &policy)
    }

    /// Returns the mean steps in a corridor of three cells with the goal at its end, from all
    /// cells. The first two cells go east or, where `ties` is true, east and west are equally good.
    fn in_a_corridor(ties: [bool; 2]) -> Option<f64> {
        let world = r#######"{ "rows": ["######", "#...G#", "######"] }"#######;
        let maze = Maze::from_json(world.as_bytes(), "corridor.json").unwrap();
        let plan = Plan::new(maze)
            .arena(ArenaKind::Grid)
            .sensor(Sensor::Position);
        let maze = &plan.maze;
        let rows = maze.free_cells().map(|cell| {
            let west = match ties.get(usize::from(cell.col) - 1) {
                Some(true) => 1.0,
                _ => 0.0,
            };
            let row = [0.0, 1.0, 0.0, west].map(Some).to_vec();
            (Sensor::Position.perceive_at(maze, cell), row)
        });
        expected_in(&plan, Knowledge::Table(rows.collect()))
    }

    #[test]
    fn at_a_tie_every_path_counts_with_its_share() {
        assert_eq!(in_a_corridor([false, false]), Some(2.0));
        // From the second cell: 2 steps or, through the first cell, 4 or 6 or ...
        assert_eq!(in_a_corridor([false, true]), None);
    }

    #[test]
    fn control_a_tie_of_equally_short_paths_changes_nothing() {
        let world = r#####"{ "rows": ["####", "#S.#", "#.G#", "####"] }"#####;
        let maze = Maze::from_json(world.as_bytes(), "square.json").unwrap();
        let plan = Plan::new(maze)
            .arena(ArenaKind::Grid)
            .sensor(Sensor::Position);
        let rows = plan.maze.free_cells().map(|cell| {
            let row = [0.0, 1.0, 1.0, 0.0].map(Some).to_vec();
            let row = match (cell.row, cell.col) {
                (1, 2) => [0.0, 0.0, 1.0, 0.0].map(Some).to_vec(),
                (2, 1) => [0.0, 1.0, 0.0, 0.0].map(Some).to_vec(),
                _ => row,
            };
            (Sensor::Position.perceive_at(&plan.maze, cell), row)
        });
        let table = Knowledge::Table(rows.collect());
        assert_eq!(expected_in(&plan, table), Some(2.0));
    }

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
