//! The best possible mean steps in a world: with a known cell, with a known world but unknown
//! start, and with only the present percept.

mod belief;
mod memoryless;

use serde::Serialize;

use crate::agent::estimator::belief::Belief;
use crate::agent::model::pomdp::{GOAL, Pomdp};
use crate::agent::planner::rtdp_bel::{BeliefPlanner, moved};
use xcs::Action;
use xcs::random::Stream;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::streams::StreamName;
use xcscr_robot::world::{Cell, Maze, Paths};

/// The step limit of an episode, because a policy may walk in circles.
const MOST_STEPS: u32 = 100;
/// Simulated episodes from each start for planning an estimate.
const PLANNED: usize = 100;
/// Simulated episodes for the mean of an estimate.
const RUNS: usize = 5_000;
/// The maximum number of cells of a world for an estimate; more would take minutes.
const MOST_PLANNED: usize = 400;
/// The maximum number of cells of a world for beliefs and memoryless policies.
const MOST_WEIGHED: usize = 1 << 16;
/// The cost if no path leads to a goal.
const NEVER: f64 = 65_535.0;

/// Minimum mean steps to a goal over all starts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bounds {
    /// The percept.
    pub sensor: Sensor,
    /// The probability that a move other than the chosen one is made (`arena.slip`).
    pub slip: f64,
    /// The full-state optimum: the cell is always known. Exact.
    pub full: f64,
    /// The unknown-start optimum: the world and the history since the start are known, but not the
    /// start. `None` if there are too many sets of cells, or, with slip, too many cells.
    pub belief: Option<Estimate>,
    /// The memoryless optimum: the best policy with one action for each percept, with episodes
    /// limited to 100 steps. `None` with slip, or in a world with too many cells.
    pub memoryless: Option<Estimate>,
}

/// A number and its possible error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Mean steps.
    pub steps: f64,
    /// 0 if exact; otherwise half the width of a 95 % interval, or by how much the true value may
    /// be lower.
    pub error: f64,
}

impl Estimate {
    fn exact(steps: f64) -> Self {
        Self { steps, error: 0.0 }
    }
}

impl Bounds {
    /// Computes the bounds of a world for a robot with `sensor` and slip probability `slip`. At
    /// slip 0 they are exact. Otherwise the unknown-start optimum is estimated: the mean of 5,000
    /// simulated episodes with a plan from real-time dynamic programming.
    pub fn new(maze: &Maze, sensor: Sensor, slip: f64) -> Self {
        let paths = Paths::with_slip(maze, slip);
        let steps = |cell| paths.expected_steps(maze, cell).unwrap_or(NEVER);
        let full = maze.starts().map(steps).sum::<f64>() / maze.starts().count() as f64;
        if cells(maze).count() > MOST_WEIGHED {
            return Self {
                sensor,
                slip,
                full,
                belief: None,
                memoryless: None,
            };
        }
        let (pomdp, starts) = known(maze, sensor, slip);
        let seen: Vec<f64> = cells(maze).map(steps).collect();
        let exact = slip == 0.0;
        let belief = match exact {
            true => belief::steps(&pomdp, &starts, &seen).map(Estimate::exact),
            false => (seen.len() <= MOST_PLANNED).then(|| estimate(&pomdp, &starts)),
        };
        Self {
            sensor,
            slip,
            full,
            belief,
            memoryless: exact.then(|| memoryless::steps(&pomdp, &starts)),
        }
    }

    /// Returns only the unknown-start optimum at slip 0. It is computed once for a maze and its
    /// clones.
    pub fn of_belief(maze: &Maze, sensor: Sensor) -> Option<f64> {
        let paths = Paths::new(maze);
        let steps = |cell| paths.expected_steps(maze, cell).unwrap_or(NEVER);
        if let Some(start) = maze.start() {
            // With a known start and exact moves, the cell is always known.
            return Some(steps(start));
        }
        maze.once(sensor.name(), || {
            if cells(maze).count() > MOST_WEIGHED {
                return None;
            }
            let (pomdp, starts) = known(maze, sensor, 0.0);
            let seen: Vec<f64> = cells(maze).map(steps).collect();
            belief::steps(&pomdp, &starts, &seen)
        })
    }
}

/// Returns the free cells that are not goals.
fn cells(maze: &Maze) -> impl Iterator<Item = Cell> + '_ {
    maze.free_cells().filter(|&cell| !maze.is_goal(cell))
}

/// Returns the true world as a POMDP, and the states in which an episode can start.
fn known(maze: &Maze, sensor: Sensor, slip: f64) -> (Pomdp, Vec<u32>) {
    let cells: Vec<Cell> = cells(maze).collect();
    let place = |cell: &Cell| (cell.row, cell.col);
    let state = |cell: Cell| {
        let at = cells.binary_search_by_key(&place(&cell), place);
        at.expect("every free cell but the goals is a state") as u32
    };
    let seen: Vec<_> = cells
        .iter()
        .map(|&cell| sensor.perceive_at(maze, cell))
        .collect();
    let next = |from: usize, action: Action| {
        let direction = maze.direction(action);
        match direction.and_then(|direction| maze.step(cells[from], direction)) {
            None => from as u32,
            Some(cell) if maze.is_goal(cell) => GOAL,
            Some(cell) => state(cell),
        }
    };
    let pomdp = Pomdp::new(maze.action_count(), slip, &seen, next);
    let starts = maze
        .start_cells()
        .into_iter()
        .filter(|&cell| !maze.is_goal(cell));
    (pomdp, starts.map(state).collect())
}

/// Returns the initial belief of an episode: the starts with this percept.
fn aliased(pomdp: &Pomdp, starts: &[u32], look: u32) -> Belief {
    Belief::even(
        starts
            .iter()
            .copied()
            .filter(|&start| pomdp.look(start) == look),
    )
}

/// Estimates the mean steps of a plan.
fn estimate(pomdp: &Pomdp, starts: &[u32]) -> Estimate {
    let mut stream = Stream::new(1, StreamName::Replay);
    let mut planner = BeliefPlanner::new(pomdp);
    for _ in 0..PLANNED {
        for &start in starts {
            let believed = aliased(pomdp, starts, pomdp.look(start));
            planner.simulate(pomdp, start, believed, &mut stream);
        }
    }
    let steps = |run: usize| {
        let start = starts[run % starts.len()];
        f64::from(run_once(
            pomdp,
            &planner,
            start,
            aliased(pomdp, starts, pomdp.look(start)),
            &mut stream,
        ))
    };
    let runs: Vec<f64> = (0..RUNS).map(steps).collect();
    let mean = runs.iter().sum::<f64>() / RUNS as f64;
    let squares: f64 = runs.iter().map(|run| (run - mean) * (run - mean)).sum();
    Estimate {
        steps: mean,
        error: 1.96 * (squares / RUNS as f64 / RUNS as f64).sqrt(),
    }
}

/// Returns the steps of an episode that follows a plan.
fn run_once(
    pomdp: &Pomdp,
    planner: &BeliefPlanner,
    start: u32,
    mut belief: Belief,
    stream: &mut Stream,
) -> u32 {
    let mut state = start;
    for step in 1..10 * MOST_STEPS {
        let action = planner.costs(pomdp, &belief).best();
        state = moved(pomdp, state, action, stream);
        if state == GOAL {
            return step;
        }
        let look = pomdp.look(state);
        belief = belief.after(pomdp, action, |_, next| pomdp.look(next) == look);
        if belief.is_empty() {
            belief = Belief::even(pomdp.aliased(look));
        }
    }
    10 * MOST_STEPS
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maze4() -> Maze {
        Maze::load("../../worlds/maze4.json".as_ref()).unwrap()
    }

    #[test]
    fn the_learners_planner_and_value_iteration_on_the_true_maze_agree_on_slips() {
        let maze = maze4();
        for slip in [0.0, 0.1, 0.25, 0.6] {
            let (pomdp, _) = known(&maze, Sensor::Position, slip);
            let paths = Paths::with_slip(&maze, slip);
            let costs = pomdp.costs_when_seen(1e6);
            for (cell, cost) in cells(&maze).zip(costs) {
                let steps = paths.expected_steps(&maze, cell).unwrap();
                assert!(
                    (cost - steps).abs() < 1e-5,
                    "slip {slip}, {cell:?}: {cost} {steps}"
                );
            }
        }
    }

    #[test]
    fn a_simulated_move_that_slips_is_never_the_chosen_one() {
        let maze = maze4();
        let (pomdp, _) = known(&maze, Sensor::Position, 0.75);
        let mut stream = Stream::new(1, StreamName::Replay);
        let action = Action::new(1).unwrap();
        // In the start cell only the action east leads elsewhere.
        let chosen = (0..10_000)
            .filter(|_| moved(&pomdp, 0, action, &mut stream) != 0)
            .count();
        assert!((2_300..2_700).contains(&chosen), "{chosen} of 10,000");
    }
}
