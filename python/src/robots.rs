//! Many independent robots in copies of one maze, simulated on all cores.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;
use xcs::{Action, Percept};
use xcscr_learner::trial::Plan;
use xcscr_robot::arena::{Arena, ArenaKind, Outcome};
use xcscr_robot::world::{Cell, Paths};

use crate::plan::{Choice, invalid};
use crate::process::{Owner, threads};
use crate::robot::free_cell;

/// Minimum number of grid robots per thread. Simulating fewer is faster than starting a thread.
const GRID_LANES_PER_THREAD: usize = 512;
/// The number of facts per robot: column, row, x and y in metres, heading in radians, collision
/// impulse in newton-seconds, and moves to the goal, or -1 without a path.
const FACTS: usize = 7;
/// The outcome code of a robot that did not act.
const NONE: u8 = u8::MAX;

/// A new episode: the number of the robot, the seed of its noise and slips, and its start cell.
type Begin = (usize, u64, (u16, u16));
/// The percept and the facts of a robot.
type State = (Percept, [f64; FACTS]);
/// A byte or a float for each robot.
type Outcomes<'py> = Bound<'py, PyBytes>;
/// The percepts and the facts of all robots.
type Observed<'py> = (Bound<'py, PyBytes>, Bound<'py, PyBytes>);

/// Robots in identical, separate mazes. Results do not depend on the number of threads.
#[pyclass(frozen, module = "xcscr._native")]
pub struct Robots {
    plan: Plan,
    paths: Paths,
    owner: Owner,
    lanes: Mutex<Vec<Box<dyn Arena>>>,
}

/// Returns the outcome as a number: 0 moved, 1 collided, 2 stalled, 3 reached the goal.
fn number(outcome: Outcome) -> u8 {
    match outcome {
        Outcome::Moved => 0,
        Outcome::Collided { .. } => 1,
        Outcome::Stalled => 2,
        Outcome::ReachedGoal => 3,
    }
}

impl Robots {
    /// Calls `act` with all robots on the threads of this process, without holding Python's lock.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut Vec<Box<dyn Arena>>) -> PyResult<T> + Send,
    ) -> PyResult<T> {
        self.owner.check("the environment")?;
        let threads = threads(py)?;
        py.detach(|| {
            let mut lanes = self.lanes.lock().unwrap_or_else(PoisonError::into_inner);
            let lanes: &mut Vec<_> = &mut lanes;
            threads.install(|| act(lanes))
        })
    }

    fn lanes_per_thread(&self) -> usize {
        match self.plan.config.arena {
            ArenaKind::Grid => GRID_LANES_PER_THREAD,
            ArenaKind::Physics => 1,
        }
    }
}

impl Robots {
    /// Returns the percept and the facts of a robot.
    fn state(&self, arena: &mut Box<dyn Arena>) -> State {
        let maze = &self.plan.maze;
        let view = arena.view();
        let (pose, cell) = (view.now().robot_in_map, view.cell);
        let distance = self.paths.distance(maze, cell).map_or(-1.0, f64::from);
        let facts = [
            cell.col.into(),
            cell.row.into(),
            pose.translation.x,
            pose.translation.y,
            pose.rotation.angle(),
            view.impulse_n_s(),
            distance,
        ];
        (self.plan.config.sensor.perceive(&view), facts)
    }

    /// Checks robots and start cells of new episodes.
    fn checked(&self, begins: Vec<Begin>) -> PyResult<BTreeMap<usize, (u64, Cell)>> {
        let cell = |(lane, seed, start)| Ok((lane, (seed, free_cell(&self.plan.maze, start)?)));
        begins.into_iter().map(cell).collect()
    }
}

#[pymethods]
impl Robots {
    #[new]
    fn new(py: Python<'_>, choice: Choice, lanes: usize) -> PyResult<Self> {
        py.detach(|| {
            let plan = choice.plan(None, 1)?;
            let arena = |_| plan.config.build_arena(&plan.maze).map_err(invalid);
            let arenas = (0..lanes).map(arena).collect::<PyResult<Vec<_>>>()?;
            Ok(Self {
                paths: Paths::new(&plan.maze),
                owner: Owner::this(),
                lanes: Mutex::new(arenas),
                plan,
            })
        })
    }

    /// Starts episodes: robots, seeds of their noise and slips, and free cells to start in.
    fn reset(&self, py: Python<'_>, begins: Vec<Begin>) -> PyResult<()> {
        let begins = self.checked(begins)?;
        let least = self.lanes_per_thread();
        self.with(py, |lanes| {
            let all = lanes.par_iter_mut().enumerate().with_min_len(least);
            all.for_each(|(lane, arena)| begin(&begins, lane, arena));
            Ok(())
        })
    }

    /// Tries to move each robot whose action is below the number of actions. Of the others, those in `begins` start an
    /// episode. Returns an outcome byte for each robot (0 moved, 1 collided, 2 stalled, 3 reached the goal, 255 did not
    /// move), and what `observe` returns.
    fn step<'py>(
        &self,
        py: Python<'py>,
        actions: &[u8],
        begins: Vec<Begin>,
    ) -> PyResult<(Outcomes<'py>, Observed<'py>)> {
        let count = self.plan.maze.action_count();
        let begins = self.checked(begins)?;
        let least = self.lanes_per_thread();
        let act = |(lane, (arena, &action)): (usize, (&mut Box<dyn Arena>, &u8))| {
            begin(&begins, lane, arena);
            let action = Action::new(usize::from(action)).filter(|action| action.index() < count);
            let code = action.map_or(NONE, |action| number(arena.act(action)));
            (code, self.state(arena))
        };
        let all: Vec<_> = self.with(py, |lanes| {
            if lanes.len() != actions.len() {
                let (given, robots) = (actions.len(), lanes.len());
                return Err(invalid(format!("{given} actions for {robots} robots")));
            }
            let all = lanes.par_iter_mut().zip(actions).enumerate();
            Ok(all.with_min_len(least).map(act).collect())
        })?;
        let codes: Vec<u8> = all.iter().map(|one| one.0).collect();
        let observed = as_bytes(py, all.iter().map(|one| &one.1));
        Ok((PyBytes::new(py, &codes), observed))
    }

    /// Returns the percepts, one byte of 0 or 1 per bit, robot by robot. Then the facts of each robot as eight-byte floats
    /// in native byte order: column, row, x and y in metres, heading in radians, impulse in newton-seconds, and moves to
    /// the goal, or -1 without a path.
    fn observe<'py>(&self, py: Python<'py>) -> PyResult<Observed<'py>> {
        let least = self.lanes_per_thread();
        let all: Vec<State> = self.with(py, |lanes| {
            let states = lanes.par_iter_mut().with_min_len(least);
            Ok(states.map(|arena| self.state(arena)).collect())
        })?;
        Ok(as_bytes(py, all.iter()))
    }
}

/// Starts the episode of a robot if there is one.
fn begin(begins: &BTreeMap<usize, (u64, Cell)>, lane: usize, arena: &mut Box<dyn Arena>) {
    if let Some(&(seed, cell)) = begins.get(&lane) {
        arena.reseed(seed);
        arena.reset(cell);
    }
}

/// Returns the percepts and the facts of robots as bytes.
fn as_bytes<'py, 'a>(
    py: Python<'py>,
    states: impl Iterator<Item = &'a State> + Clone,
) -> Observed<'py> {
    let percepts = states.clone().map(|(percept, _)| percept);
    let bits = percepts.flat_map(|one| (0..one.width()).map(|at| u8::from(one.bit(at))));
    let facts = states.flat_map(|(_, facts)| facts.iter().flat_map(|fact| fact.to_ne_bytes()));
    let [bits, facts] = [bits.collect::<Vec<u8>>(), facts.collect()];
    (PyBytes::new(py, &bits), PyBytes::new(py, &facts))
}
