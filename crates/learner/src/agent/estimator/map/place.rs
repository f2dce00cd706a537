//! Places on a map, and what lies around a robot.

use serde::{Deserialize, Serialize};

use xcs::{Action, Percept};

/// The cells around a robot, clockwise from north.
pub const NEIGHBOURS: [Place; 8] = [
    Place::new(0, 1),
    Place::new(1, 1),
    Place::new(1, 0),
    Place::new(1, -1),
    Place::new(0, -1),
    Place::new(-1, -1),
    Place::new(-1, 0),
    Place::new(-1, 1),
];

/// In place of a direction of [`NEIGHBOURS`]: no displacement.
pub const NOWHERE: usize = NEIGHBOURS.len();

/// How far a displacement goes: one of [`NEIGHBOURS`], or [`NOWHERE`].
pub fn offset(displacement: usize) -> Place {
    NEIGHBOURS
        .get(displacement)
        .copied()
        .unwrap_or(Place::ORIGIN)
}

/// Cells to the east and to the north of the goal of a map, or of where an episode began.
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
pub enum CellState {
    /// One can go there.
    Free,
    /// One cannot.
    Wall,
    /// Going there ends the episode.
    Goal,
    /// It lies between two walls, and nothing is seen of it.
    Hidden,
}

/// The state of the eight cells around a robot, clockwise from north.
pub type Surroundings = [CellState; 8];

/// The state that the first sixteen bits of a percept tell: goal or not, and barred or not.
pub fn around(percept: &Percept) -> Surroundings {
    std::array::from_fn(|at| match (percept.bit(2 * at), percept.bit(2 * at + 1)) {
        (true, true) => CellState::Goal,
        (false, true) => CellState::Wall,
        // `10` means nothing: it was misread, and most cells are free.
        (_, false) => CellState::Free,
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
    pub fn around(self, percept: &Percept) -> Surroundings {
        let state = around(percept);
        match self {
            Self::LookedUp => state,
            Self::Lidar => with_hidden(state.map(|state| match state {
                CellState::Free => CellState::Free,
                _ => CellState::Wall,
            })),
        }
    }

    /// What is seen from between these cells; `None` if that takes more than is known of them.
    pub fn seen(self, cells: [Option<CellState>; 8]) -> Option<Surroundings> {
        let hides = |at: usize| self == Self::Lidar && is_hidden(at, |at| cells[at]);
        let mut seen = [CellState::Hidden; 8];
        for (at, state) in seen.iter_mut().enumerate().filter(|(at, _)| !hides(*at)) {
            *state = cells[at]?;
        }
        Some(seen)
    }

    /// What a goal looks like.
    pub fn of_a_goal(self) -> CellState {
        match self {
            Self::LookedUp => CellState::Goal,
            Self::Lidar => CellState::Free,
        }
    }

    /// Can a cell that looks like this be a goal?
    pub fn may_be_goal(self, state: CellState) -> bool {
        state == self.of_a_goal() || self == Self::Lidar && state == CellState::Hidden
    }
}

/// Does a cell around a robot lie in a corner between two walls?
fn is_hidden(at: usize, state: impl Fn(usize) -> Option<CellState>) -> bool {
    let beside = [at + 1, at + NEIGHBOURS.len() - 1].map(|beside| state(beside % NEIGHBOURS.len()));
    at % 2 == 1 && beside == [Some(CellState::Wall); 2]
}

fn with_hidden(state: Surroundings) -> Surroundings {
    std::array::from_fn(|at| match is_hidden(at, |at| Some(state[at])) {
        true => CellState::Hidden,
        false => state[at],
    })
}

/// The percept that tells these state.
pub fn percept_of(around: &Surroundings) -> Percept {
    let bits = around.iter().flat_map(|state| match state {
        CellState::Free => [false, false],
        CellState::Wall | CellState::Hidden => [false, true],
        CellState::Goal => [true, true],
    });
    Percept::from_bits(bits).expect("sixteen bits fit into a percept")
}

/// Which of the cells around the robot an action leads to: the first is north, and the others
/// follow clockwise at even distances. This is built in where displacements are known.
pub fn heading(action: Action, actions: usize) -> usize {
    action.index() * (NEIGHBOURS.len() / actions)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(text: &str) -> Surroundings {
        let state = |state: u8| match state {
            b'.' => CellState::Free,
            b'#' => CellState::Wall,
            _ => CellState::Hidden,
        };
        let bytes: [u8; 8] = text.as_bytes().try_into().unwrap();
        bytes.map(state)
    }

    #[test]
    fn of_a_corner_between_two_walls_a_lidar_shows_nothing() {
        let (cells, shown) = (state("#.#...##"), state("#?#...#?"));
        assert_eq!(Vision::Lidar.around(&percept_of(&cells)), shown);
        assert_eq!(Vision::LookedUp.around(&percept_of(&cells)), cells);
    }

    #[test]
    fn a_place_can_be_seen_although_what_is_hidden_there_is_unknown() {
        let mut cells = state("#.#...##").map(Some);
        cells[1] = None;
        assert_eq!(Vision::Lidar.seen(cells), Some(state("#?#...#?")));
        assert_eq!(Vision::LookedUp.seen(cells), None);
        cells[3] = None;
        assert_eq!(Vision::Lidar.seen(cells), None, "control");
    }
}
