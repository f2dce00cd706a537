//! From what can be seen to a [`Percept`].

mod alike;
mod neighbours;
mod position;
mod words;

pub use alike::{Alike, alike};
use serde::{Deserialize, Serialize};
pub use words::{Alleles, action_name};

use crate::arena::View;
use crate::world::{Cell, Maze};
use xcs::Percept;

/// How the robot perceives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sensor {
    /// The eight surrounding cells, clockwise from north, two bits each: free `00`, wall `01`,
    /// goal `11` (the convention of learning classifier systems).
    Neighbours,
    /// Column, then row of the robot's cell, in binary, highest bit first.
    Position,
    /// Neighbours, then position: what lies around, and no two cells look alike.
    NeighboursPosition,
}

impl Sensor {
    /// All sensors.
    pub const ALL: [Self; 3] = [Self::Neighbours, Self::Position, Self::NeighboursPosition];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Neighbours => "neighbours",
            Self::Position => "position",
            Self::NeighboursPosition => "neighbours-position",
        }
    }

    /// The percept's width in bits, the same everywhere in a maze.
    pub fn width(self, maze: &Maze) -> usize {
        match self {
            Self::Neighbours => neighbours::WIDTH,
            Self::Position => position::width(maze),
            Self::NeighboursPosition => neighbours::WIDTH + position::width(maze),
        }
    }

    /// How many bits, the first of the percept, lie in a ring around the robot, clockwise from
    /// the way of the first action; 0 if none do.
    pub fn ring(self) -> usize {
        match self {
            Self::Neighbours | Self::NeighboursPosition => neighbours::WIDTH,
            Self::Position => 0,
        }
    }

    /// All that can be perceived in a maze from the middle of a free cell that is no goal, each
    /// percept once, in order.
    pub fn percepts(self, maze: &Maze) -> Vec<Percept> {
        let cells = maze.free_cells().filter(|&cell| !maze.is_goal(cell));
        let mut percepts: Vec<_> = cells.map(|cell| self.perceive_at(maze, cell)).collect();
        percepts.sort_unstable();
        percepts.dedup();
        percepts
    }

    /// What the robot perceives now.
    pub fn perceive(self, view: &View<'_>) -> Percept {
        self.perceive_at(view.maze, view.cell)
    }

    /// What a robot in the middle of a free cell perceives.
    pub fn perceive_at(self, maze: &Maze, cell: Cell) -> Percept {
        match self {
            Self::Neighbours => neighbours::percept(maze, cell),
            Self::Position => position::percept(maze, cell),
            Self::NeighboursPosition => {
                neighbours::percept(maze, cell).followed_by(&position::percept(maze, cell))
            }
        }
    }
}
