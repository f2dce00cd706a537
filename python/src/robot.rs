//! A robot in a maze, without a learner.

use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;
use xcs::Action;
use xcscr_learner::trial::Plan;
use xcscr_robot::arena::{Arena, Outcome};
use xcscr_robot::world::{Cell, Maze, Paths};

use crate::plan::{Choice, invalid};

/// A robot in a maze. Cells are `(column, row)`, counted from the north-western corner.
#[pyclass(frozen, module = "xcscr._native")]
pub struct Robot {
    plan: Plan,
    paths: Paths,
    /// Held only by a thread that holds Python's lock.
    arena: Mutex<Box<dyn Arena>>,
}

impl Robot {
    fn arena(&self) -> MutexGuard<'_, Box<dyn Arena>> {
        self.arena.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Robot {
    #[new]
    fn new(py: Python<'_>, choice: Choice) -> PyResult<Self> {
        py.detach(|| {
            let plan = choice.plan(None, 1)?;
            let arena = plan.config.build_arena(&plan.maze).map_err(invalid)?;
            Ok(Self {
                paths: Paths::new(&plan.maze),
                arena: Mutex::new(arena),
                plan,
            })
        })
    }

    /// Restarts the random numbers of noise and slips from a seed.
    fn reseed(&self, seed: u64) {
        self.arena().reseed(seed);
    }

    /// Places the robot at rest in the middle of a free cell.
    fn reset(&self, start: (u16, u16)) -> PyResult<()> {
        let cell = free_cell(&self.plan.maze, start)?;
        self.arena().reset(cell);
        Ok(())
    }

    /// Tries to move one cell. Returns the outcome.
    fn step(&self, action: usize) -> PyResult<&'static str> {
        let action = Action::new(action).filter(|action| action.index() < self.actions());
        let action = action.ok_or_else(|| {
            invalid(format!(
                "the action must be from 0 to {}",
                self.actions() - 1
            ))
        })?;
        Ok(match self.arena().act(action) {
            Outcome::Moved => "moved",
            Outcome::Collided { .. } => "collided",
            Outcome::Stalled => "stalled",
            Outcome::ReachedGoal => "reached-goal",
        })
    }

    /// Returns the percept, one byte of 0 or 1 per bit.
    fn percept(&self) -> Vec<u8> {
        let percept = self.plan.config.sensor.perceive(&self.arena().view());
        (0..percept.width())
            .map(|at| u8::from(percept.bit(at)))
            .collect()
    }

    /// Returns the pose in the map frame: x and y in metres, heading in radians from the x axis.
    #[getter]
    fn pose(&self) -> (f64, f64, f64) {
        let pose = self.arena().view().now().robot_in_map;
        (
            pose.translation.x,
            pose.translation.y,
            pose.rotation.angle(),
        )
    }

    /// Returns the robot's estimate of its cell.
    #[getter]
    fn cell(&self) -> (u16, u16) {
        let cell = self.arena().view().cell;
        (cell.col, cell.row)
    }

    /// Returns the total impulse of the collisions during the last action, in newton-seconds.
    #[getter]
    fn collision_impulse(&self) -> f64 {
        self.arena().view().impulse_n_s()
    }

    /// Returns the length of the shortest path from a cell to a goal, in moves; `None` if there is
    /// none.
    fn shortest_distance(&self, cell: (u16, u16)) -> PyResult<Option<u32>> {
        let cell = free_cell(&self.plan.maze, cell)?;
        Ok(self.paths.distance(&self.plan.maze, cell))
    }

    /// Returns the number of actions. Actions are numbered clockwise from north.
    #[getter]
    fn actions(&self) -> usize {
        self.plan.maze.action_count()
    }

    /// Returns the number of bits of a percept.
    #[getter]
    fn percept_bits(&self) -> usize {
        self.plan.config.sensor.width(&self.plan.maze)
    }

    /// Returns the name of the sensor.
    #[getter]
    fn sensor(&self) -> &'static str {
        self.plan.config.sensor.name()
    }

    /// Returns the name of the world.
    #[getter]
    fn world(&self) -> &str {
        self.plan.maze.name()
    }

    /// Returns the text of the world file.
    #[getter]
    fn world_json(&self) -> String {
        self.plan.maze.to_json()
    }

    /// Returns the numbers of columns and rows.
    #[getter]
    fn size(&self) -> (u16, u16) {
        (self.plan.maze.width(), self.plan.maze.height())
    }

    /// Returns the maximum number of steps per episode from the settings.
    #[getter]
    fn step_threshold(&self) -> u32 {
        self.plan.config.settings.reward.step_threshold
    }

    /// Returns the cells in which an episode can start.
    #[getter]
    fn start_cells(&self) -> Vec<(u16, u16)> {
        let cells = self.plan.maze.start_cells();
        cells.iter().map(|cell| (cell.col, cell.row)).collect()
    }

    /// Returns the goal cells.
    #[getter]
    fn goals(&self) -> Vec<(u16, u16)> {
        let goals = self.plan.maze.goals();
        goals.iter().map(|cell| (cell.col, cell.row)).collect()
    }

    /// Returns whether each cell is a wall, row by row.
    #[getter]
    fn walls(&self) -> Vec<Vec<bool>> {
        let maze = &self.plan.maze;
        let row = |row| (0..maze.width()).map(move |col| maze.is_wall(Cell { col, row }));
        (0..maze.height()).map(|r| row(r).collect()).collect()
    }
}

/// Returns a cell if it is inside the maze and not a wall.
pub fn free_cell(maze: &Maze, (col, row): (u16, u16)) -> PyResult<Cell> {
    let cell = Cell { col, row };
    let inside = col < maze.width() && row < maze.height();
    match inside && !maze.is_wall(cell) {
        true => Ok(cell),
        false => Err(invalid(format!(
            "({col}, {row}) is not a free cell of {}",
            maze.name()
        ))),
    }
}
