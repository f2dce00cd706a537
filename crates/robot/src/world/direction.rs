//! The compass directions in which a robot can move.

use serde::{Deserialize, Serialize};

/// A compass direction; north is toward row 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Toward row 0.
    North,
    /// Between north and east.
    NorthEast,
    /// Toward the last column.
    East,
    /// Between south and east.
    SouthEast,
    /// Toward the last row.
    South,
    /// Between south and west.
    SouthWest,
    /// Toward column 0.
    West,
    /// Between north and west.
    NorthWest,
}

impl Direction {
    /// The eight directions, clockwise from north.
    pub const CLOCKWISE: [Self; 8] = [
        Self::North,
        Self::NorthEast,
        Self::East,
        Self::SouthEast,
        Self::South,
        Self::SouthWest,
        Self::West,
        Self::NorthWest,
    ];
    /// The four main directions, clockwise from north.
    pub const MAIN: [Self; 4] = [Self::North, Self::East, Self::South, Self::West];

    /// Returns the columns to the east and the rows to the south that one move covers.
    pub fn offset(self) -> (i32, i32) {
        match self {
            Self::North => (0, -1),
            Self::NorthEast => (1, -1),
            Self::East => (1, 0),
            Self::SouthEast => (1, 1),
            Self::South => (0, 1),
            Self::SouthWest => (-1, 1),
            Self::West => (-1, 0),
            Self::NorthWest => (-1, -1),
        }
    }

    /// Returns the two main directions beside a diagonal one; `None` for a main direction.
    pub fn sides(self) -> Option<[Self; 2]> {
        match self {
            Self::NorthEast => Some([Self::North, Self::East]),
            Self::SouthEast => Some([Self::South, Self::East]),
            Self::SouthWest => Some([Self::South, Self::West]),
            Self::NorthWest => Some([Self::North, Self::West]),
            Self::North | Self::East | Self::South | Self::West => None,
        }
    }

    /// Returns the name used in files: `north`, `north-east`, ...
    pub fn name(self) -> &'static str {
        match self {
            Self::North => "north",
            Self::NorthEast => "north-east",
            Self::East => "east",
            Self::SouthEast => "south-east",
            Self::South => "south",
            Self::SouthWest => "south-west",
            Self::West => "west",
            Self::NorthWest => "north-west",
        }
    }

    /// Returns an arrow that points in this direction.
    pub fn arrow(self) -> char {
        match self {
            Self::North => '↑',
            Self::NorthEast => '↗',
            Self::East => '→',
            Self::SouthEast => '↘',
            Self::South => '↓',
            Self::SouthWest => '↙',
            Self::West => '←',
            Self::NorthWest => '↖',
        }
    }
}

/// The directions that count as moves in a world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Moves {
    /// North, east, south, west.
    #[default]
    Four,
    /// All eight, clockwise from north; a diagonal move may cut a corner.
    Eight,
}

impl Moves {
    /// Returns the directions in the order of the action numbers.
    pub fn directions(self) -> &'static [Direction] {
        match self {
            Self::Four => &Direction::MAIN,
            Self::Eight => &Direction::CLOCKWISE,
        }
    }
}
