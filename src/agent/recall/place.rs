//! Places on a chart, and what lies around a robot.

use serde::{Deserialize, Serialize};

use xcs::{Action, Percept};

/// The cells around a robot, clockwise from north.
pub const AROUND: [Place; 8] = [
    Place::new(0, 1),
    Place::new(1, 1),
    Place::new(1, 0),
    Place::new(1, -1),
    Place::new(0, -1),
    Place::new(-1, -1),
    Place::new(-1, 0),
    Place::new(-1, 1),
];

/// Cells to the east and to the north of the goal of a chart, or of where an episode began.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub struct Place {
    /// To the east.
    pub east: i16,
    /// To the north.
    pub north: i16,
}

impl Place {
    /// Where all counting begins.
    pub const ORIGIN: Self = Self::new(0, 0);

    /// So many cells to the east and to the north.
    pub const fn new(east: i16, north: i16) -> Self {
        Self { east, north }
    }

    /// The place so far from this one.
    pub fn plus(self, by: Self) -> Self {
        Self::new(self.east + by.east, self.north + by.north)
    }

    /// The place from which this one is so far away.
    pub fn minus(self, by: Self) -> Self {
        Self::new(self.east - by.east, self.north - by.north)
    }

    /// How many moves it is from the origin, if every move is allowed.
    pub fn reach(self) -> u16 {
        self.east.unsigned_abs().max(self.north.unsigned_abs())
    }
}

/// What a cell is, as a percept tells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Letter {
    /// One can go there.
    Free,
    /// One cannot.
    Wall,
    /// Going there ends the episode.
    Goal,
}

/// The letters of the eight cells around a robot, clockwise from north.
pub type Around = [Letter; 8];

/// The letters that the first sixteen bits of a percept tell: goal or not, and barred or not.
pub fn around(percept: &Percept) -> Around {
    std::array::from_fn(|at| match (percept.bit(2 * at), percept.bit(2 * at + 1)) {
        (true, true) => Letter::Goal,
        (false, true) => Letter::Wall,
        // `10` means nothing: it was misread, and most cells are free.
        (_, false) => Letter::Free,
    })
}

/// The percept that tells these letters.
pub fn percept_of(around: &Around) -> Percept {
    let bits = around.iter().flat_map(|letter| match letter {
        Letter::Free => [false, false],
        Letter::Wall => [false, true],
        Letter::Goal => [true, true],
    });
    Percept::from_bits(bits).expect("sixteen bits fit into a percept")
}

/// Which of the cells around the robot an action leads to: the first is north, and the others
/// follow clockwise at even distances. This is built in.
pub fn heading(action: Action, actions: usize) -> usize {
    action.index() * (AROUND.len() / actions)
}
