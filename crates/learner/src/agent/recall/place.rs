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

/// In place of a direction of [`AROUND`]: no displacement.
pub const NOWHERE: usize = AROUND.len();

/// How far a displacement goes: one of [`AROUND`], or [`NOWHERE`].
pub fn offset(displacement: usize) -> Place {
    AROUND.get(displacement).copied().unwrap_or(Place::ORIGIN)
}

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
    /// It lies between two walls, and nothing is seen of it.
    Hidden,
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

/// How the cells around a robot come into its percept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Vision {
    /// They are looked up, all of them.
    #[default]
    LookedUp,
    /// A lidar shows them: goals look free, and a corner between two walls looks like a wall.
    Lidar,
}

impl Vision {
    /// What a percept tells of the cells around the robot.
    pub fn around(self, percept: &Percept) -> Around {
        let letters = around(percept);
        match self {
            Self::LookedUp => letters,
            Self::Lidar => with_hidden(letters.map(|letter| match letter {
                Letter::Free => Letter::Free,
                _ => Letter::Wall,
            })),
        }
    }

    /// What is seen from between these cells; `None` if that takes more than is known of them.
    pub fn seen(self, cells: [Option<Letter>; 8]) -> Option<Around> {
        let hides = |at: usize| self == Self::Lidar && is_hidden(at, |at| cells[at]);
        let mut seen = [Letter::Hidden; 8];
        for (at, letter) in seen.iter_mut().enumerate().filter(|(at, _)| !hides(*at)) {
            *letter = cells[at]?;
        }
        Some(seen)
    }

    /// What a goal looks like.
    pub fn of_a_goal(self) -> Letter {
        match self {
            Self::LookedUp => Letter::Goal,
            Self::Lidar => Letter::Free,
        }
    }

    /// Can a cell that looks like this be a goal?
    pub fn may_be_goal(self, letter: Letter) -> bool {
        letter == self.of_a_goal() || self == Self::Lidar && letter == Letter::Hidden
    }
}

/// Does a cell around a robot lie in a corner between two walls?
fn is_hidden(at: usize, letter: impl Fn(usize) -> Option<Letter>) -> bool {
    let beside = [at + 1, at + AROUND.len() - 1].map(|beside| letter(beside % AROUND.len()));
    at % 2 == 1 && beside == [Some(Letter::Wall); 2]
}

fn with_hidden(letters: Around) -> Around {
    std::array::from_fn(|at| match is_hidden(at, |at| Some(letters[at])) {
        true => Letter::Hidden,
        false => letters[at],
    })
}

/// The percept that tells these letters.
pub fn percept_of(around: &Around) -> Percept {
    let bits = around.iter().flat_map(|letter| match letter {
        Letter::Free => [false, false],
        Letter::Wall | Letter::Hidden => [false, true],
        Letter::Goal => [true, true],
    });
    Percept::from_bits(bits).expect("sixteen bits fit into a percept")
}

/// Which of the cells around the robot an action leads to: the first is north, and the others
/// follow clockwise at even distances. This is built in where displacements are known.
pub fn heading(action: Action, actions: usize) -> usize {
    action.index() * (AROUND.len() / actions)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn letters(text: &str) -> Around {
        let letter = |letter: u8| match letter {
            b'.' => Letter::Free,
            b'#' => Letter::Wall,
            _ => Letter::Hidden,
        };
        let bytes: [u8; 8] = text.as_bytes().try_into().unwrap();
        bytes.map(letter)
    }

    #[test]
    fn of_a_corner_between_two_walls_a_lidar_shows_nothing() {
        let (cells, shown) = (letters("#.#...##"), letters("#?#...#?"));
        assert_eq!(Vision::Lidar.around(&percept_of(&cells)), shown);
        assert_eq!(Vision::LookedUp.around(&percept_of(&cells)), cells);
    }

    #[test]
    fn a_place_can_be_seen_although_what_is_hidden_there_is_unknown() {
        let mut cells = letters("#.#...##").map(Some);
        cells[1] = None;
        assert_eq!(Vision::Lidar.seen(cells), Some(letters("#?#...#?")));
        assert_eq!(Vision::LookedUp.seen(cells), None);
        cells[3] = None;
        assert_eq!(Vision::Lidar.seen(cells), None, "control");
    }
}
