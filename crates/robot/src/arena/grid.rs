//! The maze as a grid: a move is one step from cell to cell and takes one second.

use nalgebra::{Complex, Isometry2, UnitComplex};

use super::{Arena, Contact, Outcome, Sample, View, first_cell};
use crate::world::{Cell, Direction, Maze};
use xcs::Action;

/// Duration of a move, in nanoseconds.
const MOVE_NS: u64 = 1_000_000_000;

/// The arena without physics: exact and fast.
#[derive(Debug, Clone)]
pub struct GridArena {
    maze: Maze,
    cell: Cell,
    trace: [Sample; 2],
    contacts: Vec<Contact>,
}

impl GridArena {
    /// Creates a grid arena with the robot in the first start cell.
    pub fn new(maze: Maze) -> Self {
        let cell = first_cell(&maze);
        let rest = Sample {
            time_ns: 0,
            robot_in_map: pose(&maze, cell, Direction::East),
            wheel_travel_m: [0.0; 2],
        };
        Self {
            maze,
            cell,
            trace: [rest; 2],
            contacts: Vec::new(),
        }
    }
}

impl Arena for GridArena {
    fn reset(&mut self, start: Cell) {
        self.cell = start;
        let rest = Sample {
            time_ns: self.trace[1].time_ns,
            robot_in_map: pose(&self.maze, start, Direction::East),
            wheel_travel_m: [0.0; 2],
        };
        self.trace = [rest; 2];
        self.contacts.clear();
    }

    fn act(&mut self, action: Action) -> Outcome {
        let before = self.trace[1];
        let Some(direction) = self.maze.direction(action) else {
            return Outcome::Stalled;
        };
        let next = self.maze.step(self.cell, direction);
        self.cell = next.unwrap_or(self.cell);
        self.contacts.clear();
        let after = Sample {
            time_ns: before.time_ns + MOVE_NS,
            robot_in_map: pose(&self.maze, self.cell, direction),
            ..before
        };
        self.trace = [before, after];
        match next {
            None => Outcome::Collided { impulse_n_s: None },
            Some(cell) if self.maze.is_goal(cell) => Outcome::ReachedGoal,
            Some(_) => Outcome::Moved,
        }
    }

    fn view(&self) -> View<'_> {
        View {
            maze: &self.maze,
            cell: self.cell,
            trace: &self.trace,
            contacts: &self.contacts,
            sensed: None,
            executed: None,
            flipped: None,
            wheels_mps: None,
        }
    }

    fn set_clock(&mut self, time_ns: u64) {
        self.trace[1].time_ns = time_ns;
    }

    fn reseed(&mut self, _: u64) {
        self.trace[1].time_ns = 0;
        self.reset(first_cell(&self.maze));
    }
}

/// Returns the pose at the middle of a cell with the given heading, in the map frame.
fn pose(maze: &Maze, cell: Cell, direction: Direction) -> Isometry2<f64> {
    let (east, south) = direction.offset();
    let heading = Complex::new(f64::from(east), f64::from(-south));
    let heading = UnitComplex::new_normalize(heading);
    maze.pose_in_map(Isometry2::from_parts(
        maze.centre_in_grid(cell).into(),
        heading,
    ))
}
