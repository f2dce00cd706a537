//! Many independent robots in copies of one maze, simulated on all cores.

use std::sync::Mutex;

use pyo3::prelude::*;
use rayon::prelude::*;
use xcs::Action;
use xcscr_learner::trial::Plan;
use xcscr_robot::arena::{Arena, ArenaKind, Outcome};
use xcscr_robot::world::Paths;

use crate::plan::{Choice, invalid};
use crate::robot::free_cell;

/// Minimum number of grid robots per thread. Simulating fewer is faster than starting a thread.
const GRID_LANES_PER_THREAD: usize = 512;
/// The number of facts per robot: column, row, x and y in metres, heading in radians, collision
/// impulse in newton-seconds, and moves to the goal, or -1 without a path.
const FACTS: usize = 7;
/// The outcome code of a robot that did not act.
const NONE: u8 = u8::MAX;

/// Robots in identical, separate mazes. Results do not depend on the number of threads.
#[pyclass(frozen, module = "xcscr._native")]
pub struct Robots {
    plan: Plan,
    paths: Paths,
    lanes: Mutex<Vec<Box<dyn Arena>>>,
}

/// Returns the outcome as a number: 0 moved, 1 found a reward, 2 collided, 3 stalled, 4 reached the
/// goal.
fn number(outcome: Outcome) -> u8 {
    match outcome {
        Outcome::Moved => 0,
        Outcome::FoundReward { .. } => 1,
        Outcome::Collided { .. } => 2,
        Outcome::Stalled => 3,
        Outcome::ReachedGoal => 4,
    }
}

impl Robots {
    /// Calls `act` with all robots, without holding Python's lock.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut Vec<Box<dyn Arena>>) -> T + Send,
    ) -> T {
        py.detach(|| {
            let lanes = self.lanes.lock();
            act(&mut lanes.unwrap_or_else(std::sync::PoisonError::into_inner))
        })
    }

    fn lanes_per_thread(&self) -> usize {
        match self.plan.config.arena {
            ArenaKind::Grid => GRID_LANES_PER_THREAD,
            ArenaKind::Physics => 1,
        }
    }
}

#[pymethods]
impl Robots {
    #[new]
    fn new(py: Python<'_>, choice: Choice, lanes: usize) -> PyResult<Self> {
        let plan = choice.plan(None, 1)?;
        let arena = |_| plan.config.build_arena(&plan.maze).map_err(invalid);
        let arenas = (0..lanes).map(arena).collect::<PyResult<Vec<_>>>()?;
        py.check_signals()?;
        Ok(Self {
            paths: Paths::new(&plan.maze),
            lanes: Mutex::new(arenas),
            plan,
        })
    }

    /// Places some robots in free cells. The noise and slips of each robot restart from its seed.
    fn reset(
        &self,
        py: Python<'_>,
        lanes: Vec<usize>,
        seeds: Vec<u64>,
        starts: Vec<(u16, u16)>,
    ) -> PyResult<()> {
        let maze = &self.plan.maze;
        let cells: PyResult<Vec<_>> = starts.iter().map(|&start| free_cell(maze, start)).collect();
        let wanted: Vec<_> = lanes
            .into_iter()
            .zip(seeds.into_iter().zip(cells?))
            .collect();
        let put = |&(lane, (seed, cell)): &(usize, (u64, _))| {
            let mut config = self.plan.config.clone();
            config.seed = seed;
            let mut arena = config
                .build_arena(maze)
                .map_err(|fault| fault.to_string())?;
            arena.reset(cell);
            Ok((lane, arena))
        };
        self.with(py, |all| {
            let new: Result<Vec<_>, String> = wanted.par_iter().map(put).collect();
            for (lane, arena) in new? {
                let robot = all.get_mut(lane);
                *robot.ok_or_else(|| format!("there is no robot {lane}"))? = arena;
            }
            Ok(())
        })
        .map_err(|fault: String| invalid(fault))
    }

    /// Tries to move each robot whose action is below the number of actions. The others rest.
    /// Returns an outcome byte for each robot (0 moved, 1 found a reward, 2 collided, 3 stalled, 4
    /// reached the goal, 255 rested), and the auxiliary rewards.
    fn step(&self, py: Python<'_>, actions: &[u8]) -> PyResult<(Vec<u8>, Vec<f64>)> {
        let count = self.plan.maze.action_count();
        let act = |(arena, &action): (&mut Box<dyn Arena>, &u8)| {
            let action = Action::new(usize::from(action)).filter(|action| action.index() < count);
            action.map_or((NONE, 0.0), |action| {
                let outcome = arena.act(action);
                (number(outcome), outcome.found())
            })
        };
        let least = self.lanes_per_thread();
        self.with(py, |lanes| {
            if lanes.len() != actions.len() {
                return Err(format!(
                    "{} actions for {} robots",
                    actions.len(),
                    lanes.len()
                ));
            }
            let all = lanes.par_iter_mut().zip(actions).with_min_len(least);
            Ok(all.map(act).unzip())
        })
        .map_err(invalid)
    }

    /// Returns the percepts, one byte of 0 or 1 per bit, robot by robot.
    fn percepts(&self, py: Python<'_>) -> Vec<u8> {
        let sensor = self.plan.config.sensor;
        let least = self.lanes_per_thread();
        let bits = |arena: &mut Box<dyn Arena>| {
            let percept = sensor.perceive(&arena.view());
            let bits = (0..percept.width()).map(move |at| u8::from(percept.bit(at)));
            bits.collect::<Vec<u8>>()
        };
        self.with(py, |lanes| {
            let percepts = lanes.par_iter_mut().with_min_len(least).map(bits);
            percepts.collect::<Vec<_>>().concat()
        })
    }

    /// Returns the facts of each robot as eight-byte floats in native byte order, robot by robot:
    /// column, row, x and y in metres, heading in radians, impulse in newton-seconds, and moves to
    /// the goal, or -1 without a path.
    fn facts(&self, py: Python<'_>) -> Vec<u8> {
        let maze = &self.plan.maze;
        let facts = |arena: &mut Box<dyn Arena>| {
            let view = arena.view();
            let (pose, cell) = (view.now().robot_in_map, view.cell);
            let impulse: f64 = view.contacts.iter().map(|contact| contact.impulse_ns).sum();
            let distance = self.paths.distance(maze, cell).map_or(-1.0, f64::from);
            let facts: [f64; FACTS] = [
                cell.col.into(),
                cell.row.into(),
                pose.translation.x,
                pose.translation.y,
                pose.rotation.angle(),
                impulse,
                distance,
            ];
            facts.map(f64::to_ne_bytes).concat()
        };
        let least = self.lanes_per_thread();
        self.with(py, |lanes| {
            let facts = lanes.par_iter_mut().with_min_len(least).map(facts);
            facts.collect::<Vec<_>>().concat()
        })
    }
}
