//! Cells of a map and the surroundings of a robot.

use serde::{Deserialize, Serialize};

use xcs::{Action, Percept};

/// The displacements to the eight cells around a robot, clockwise from north.
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

/// The displacement number of no displacement, next to the numbers of [`NEIGHBOURS`].
pub const NOWHERE: usize = NEIGHBOURS.len();

/// Returns the offset of a displacement number: one of [`NEIGHBOURS`], or [`NOWHERE`].
pub fn offset(displacement: usize) -> Place {
    NEIGHBOURS
        .get(displacement)
        .copied()
        .unwrap_or(Place::ORIGIN)
}

/// The position of a cell, in cells east and north of the map's goal or of the episode's start.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
pub struct Place {
    /// Cells to the east.
    pub east: i16,
    /// Cells to the north.
    pub north: i16,
}

impl Place {
    /// The origin of the map.
    pub const ORIGIN: Self = Self::new(0, 0);

    /// Creates a position from cells to the east and to the north.
    pub const fn new(east: i16, north: i16) -> Self {
        Self { east, north }
    }

    /// Returns the component-wise sum.
    pub fn plus(self, by: Self) -> Self {
        Self::new(self.east + by.east, self.north + by.north)
    }

    /// Returns the component-wise difference.
    pub fn minus(self, by: Self) -> Self {
        Self::new(self.east - by.east, self.north - by.north)
    }

    /// Returns the number of moves from the origin, if no wall bars the way.
    pub fn reach(self) -> u16 {
        self.east.unsigned_abs().max(self.north.unsigned_abs())
    }
}

/// The state of a cell, as perceived.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum CellState {
    /// The robot can enter the cell.
    Free,
    /// The robot cannot enter the cell.
    Wall,
    /// Entering the cell ends the episode.
    Goal,
    /// A corner between two walls, which cannot be seen.
    Hidden,
}

/// The state of the eight cells around a robot, clockwise from north.
pub type Surroundings = [CellState; 8];

/// Decodes the first sixteen bits of a percept, two per cell: goal or not, and barred or not.
pub fn around(percept: &Percept) -> Surroundings {
    std::array::from_fn(|at| match (percept.bit(2 * at), percept.bit(2 * at + 1)) {
        (true, true) => CellState::Goal,
        (false, true) => CellState::Wall,
        // `10` encodes no state. It is an observation error, and most cells are free.
        (_, false) => CellState::Free,
    })
}

/// The source of the robot's percepts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Vision {
    /// All cells are ground truth, looked up in the maze.
    #[default]
    GroundTruth,
    /// A lidar senses the cells: goals look free, and a corner between two walls looks like a wall.
    Lidar,
}

impl Vision {
    /// Returns the surroundings that a percept shows.
    pub fn around(self, percept: &Percept) -> Surroundings {
        let shown = around(percept).map(|state| match (self, state) {
            (Self::Lidar, CellState::Goal) => CellState::Wall,
            _ => state,
        });
        self.seen(shown.map(Some)).expect("every cell is known")
    }

    /// Returns the percept among these cells; `None` if it depends on an unknown cell.
    pub fn seen(self, cells: [Option<CellState>; 8]) -> Option<Surroundings> {
        let hides = |at: usize| self == Self::Lidar && is_hidden(at, |at| cells[at]);
        let mut seen = [CellState::Hidden; 8];
        for (at, state) in seen.iter_mut().enumerate().filter(|(at, _)| !hides(*at)) {
            *state = cells[at]?;
        }
        Some(seen)
    }

    /// Returns the cell state as which a goal is perceived.
    pub fn of_a_goal(self) -> CellState {
        match self {
            Self::GroundTruth => CellState::Goal,
            Self::Lidar => CellState::Free,
        }
    }

    /// Returns true if a cell with this perceived state can be a goal.
    pub fn may_be_goal(self, state: CellState) -> bool {
        state == self.of_a_goal() || self == Self::Lidar && state == CellState::Hidden
    }
}

/// Returns true if a cell around the robot is in a corner between two walls.
fn is_hidden(at: usize, state: impl Fn(usize) -> Option<CellState>) -> bool {
    let beside = [at + 1, at + NEIGHBOURS.len() - 1].map(|beside| state(beside % NEIGHBOURS.len()));
    at % 2 == 1 && beside == [Some(CellState::Wall); 2]
}

/// Returns the cells that a robot in a free cell perceives, its own cell first, with their states.
pub fn shown(
    place: Place,
    around: &Surroundings,
) -> impl Iterator<Item = (Place, CellState)> + use<> {
    let cells = NEIGHBOURS.into_iter().zip(*around);
    let cells = cells.filter(|(_, state)| *state != CellState::Hidden);
    let cells = cells.map(move |(by, state)| (place.plus(by), state));
    std::iter::once((place, CellState::Free)).chain(cells)
}

/// Encodes surroundings as a percept.
pub fn percept_of(around: &Surroundings) -> Percept {
    let bits = around.iter().flat_map(|state| match state {
        CellState::Free => [false, false],
        CellState::Wall | CellState::Hidden => [false, true],
        CellState::Goal => [true, true],
    });
    Percept::from_bits(bits).expect("sixteen bits fit into a percept")
}

/// Returns the displacement number of an action with a known motion model. The first action leads north,
/// and the others follow clockwise at equal angles.
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
    fn a_lidar_shows_nothing_of_a_corner_between_two_walls() {
        let (cells, shown) = (state("#.#...##"), state("#?#...#?"));
        assert_eq!(Vision::Lidar.around(&percept_of(&cells)), shown);
        assert_eq!(Vision::GroundTruth.around(&percept_of(&cells)), cells);
    }

    #[test]
    fn a_percept_is_known_although_a_hidden_cell_is_unknown() {
        let mut cells = state("#.#...##").map(Some);
        cells[1] = None;
        assert_eq!(Vision::Lidar.seen(cells), Some(state("#?#...#?")));
        assert_eq!(Vision::GroundTruth.seen(cells), None);
        cells[3] = None;
        assert_eq!(Vision::Lidar.seen(cells), None, "control");
    }
}
