//! From what can be seen to a [`Percept`].

mod alike;
mod neighbours;
mod position;

pub use alike::{Alike, alike};
use serde::{Deserialize, Serialize};

use crate::arena::View;
use crate::signal::Percept;
use crate::world::{Cell, Maze};

/// How the robot perceives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sensor {
    /// The eight surrounding cells, clockwise from north, two bits each: free `00`, wall `01`,
    /// goal `11` (the convention of learning classifier systems).
    Neighbours,
    /// Column, then row of the robot's cell, in binary, highest bit first.
    Position,
}

impl Sensor {
    /// All sensors.
    pub const ALL: [Self; 2] = [Self::Neighbours, Self::Position];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Neighbours => "neighbours",
            Self::Position => "position",
        }
    }

    /// The percept's width in bits, the same everywhere in a maze.
    pub fn width(self, maze: &Maze) -> usize {
        match self {
            Self::Neighbours => neighbours::WIDTH,
            Self::Position => position::width(maze),
        }
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
        }
    }
}
