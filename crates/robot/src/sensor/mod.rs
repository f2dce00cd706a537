//! Converts the observable state of an arena to a [`Percept`].
//!
//! Some percepts are *looked up* in the maze, at the robot's true cell. Real robots have no such
//! access; these percepts are for the grid, and for the paper's results. Others are *sensed*: in
//! the physics arena they are computed only from the robot's lidar. On the grid they are those of a
//! perfect lidar.

mod aliasing;
mod history;
mod lidar;
mod neighbours;
mod params;
mod position;
mod words;

use std::collections::HashSet;

pub use aliasing::AliasedCells;
pub use aliasing::aliased_among;
use foldhash::fast::FixedState;
pub use history::{History, MOST_EARLIER_STEPS, Perception};
pub use params::SensorParams;
use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};
pub use words::{ANYTHING, Alleles, Demands};

use crate::arena::{ArenaKind, LocalMap, View};
use crate::world::{Cell, CellState, Direction, Maze, Paths};
use xcs::{Layout, Percept};

/// The encodings of what the robot perceives as a percept (`--sensor`). Devices, such as the
/// lidar, belong to the robot of the physics arena.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, IntoStaticStr, VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Sensor {
    /// The eight surrounding cells, clockwise from north, two bits each: free `00`, wall `01`,
    /// goal `11` (the convention of learning classifier systems).
    Neighbours,
    /// Column, then row of the robot's cell, in binary, highest bit first.
    Position,
    /// Neighbours, then position. No two cells have the same percept.
    NeighboursPosition,
    /// The eight surrounding cells as a lidar shows them: two bits each, free `00`, wall or hidden
    /// `01`. A lidar sees no goal.
    Lidar,
    /// The eight surrounding cells as a lidar shows them, then column and row of the robot's
    /// estimated cell. The robot is given its start cell, and tracks its position with its sensors.
    LidarPosition,
}

impl Sensor {
    /// All sensors.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// Returns the default sensor of an arena: the surroundings of the robot, as the literature on learning classifier
    /// systems has them on the grid, and as a lidar sees them in physics.
    pub fn usual_in(arena: ArenaKind) -> Self {
        match arena {
            ArenaKind::Physics => Self::Lidar,
            ArenaKind::Grid => Self::Neighbours,
        }
    }

    /// Returns the default sensor for learning in a maze: [`usual_in`](Self::usual_in),
    /// [with the position](Self::with_position) if no policy on the surroundings is optimal.
    pub fn usual_for(arena: ArenaKind, maze: &Maze) -> Self {
        let usual = Self::usual_in(arena);
        if usual.misleads(maze, &Paths::new(maze)) {
            usual.with_position()
        } else {
            usual
        }
    }

    /// Returns the sensor that also gives column and row of the robot's cell.
    #[must_use]
    pub fn with_position(self) -> Self {
        match self {
            Self::Neighbours | Self::NeighboursPosition => Self::NeighboursPosition,
            Self::Position => Self::Position,
            Self::Lidar | Self::LidarPosition => Self::LidarPosition,
        }
    }

    /// Returns true if no action is best in all of some cells on shortest paths that share a percept.
    pub fn misleads(self, maze: &Maze, paths: &Paths) -> bool {
        !self.misleading(maze, paths).is_empty()
    }

    /// Returns the groups of cells on shortest paths that share a percept but no best action.
    pub fn misleading(self, maze: &Maze, paths: &Paths) -> Vec<Vec<Cell>> {
        let groups = aliased_among(self, maze, paths, paths.cells_on_shortest(maze));
        let misleading = groups
            .into_iter()
            .filter(|group| !group.share_a_best_action);
        misleading.map(|group| group.cells).collect()
    }

    /// Returns the name used on the command line and in files.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Returns true if the percept is computed from sensor readings. All others are looked up in
    /// the maze, which no real robot could do.
    pub fn is_sensed(self) -> bool {
        match self {
            Self::Neighbours | Self::Position | Self::NeighboursPosition => false,
            Self::Lidar | Self::LidarPosition => true,
        }
    }

    /// Returns the percept's width in bits, which is the same everywhere in a maze.
    pub fn width(self, maze: &Maze) -> usize {
        match self {
            Self::Neighbours => neighbours::WIDTH,
            Self::Position => position::width(maze),
            Self::NeighboursPosition => neighbours::WIDTH + position::width(maze),
            Self::Lidar => lidar::AROUND,
            Self::LidarPosition => lidar::AROUND + position::width(maze),
        }
    }

    /// Returns the numbers of bits that encode the robot's column and row. They are the last bits
    /// of the percept; most percepts have none.
    pub fn place_bits(self, maze: &Maze) -> [usize; 2] {
        let of_column = position::col_width(maze);
        match self {
            Self::Neighbours | Self::Lidar => [0; 2],
            Self::Position | Self::NeighboursPosition | Self::LidarPosition => {
                [of_column, position::width(maze) - of_column]
            }
        }
    }

    /// Returns the layout of percepts: the robot's column and row are numbers.
    pub fn layout(self, maze: &Maze) -> Layout {
        let [of_column, of_row] = self.place_bits(maze);
        let rows = self.width(maze) - of_row;
        let layout = Layout::with_numbers([rows - of_column..rows, rows..rows + of_row]);
        layout.expect("a column and a row of at most 16 bits each")
    }

    /// Returns the number of leading bits that form a ring around the robot, clockwise from the
    /// direction of the first of `moves` moves. Returns 0 without a ring, or if it has no equal
    /// part for each move.
    pub fn ring(self, moves: usize) -> usize {
        match self.begins_with_neighbours() && 8 % moves == 0 {
            true => lidar::AROUND,
            false => 0,
        }
    }

    /// Returns true if the percept begins with the eight cells around the robot, two bits each.
    pub fn begins_with_neighbours(self) -> bool {
        matches!(
            self,
            Self::Neighbours | Self::NeighboursPosition | Self::Lidar | Self::LidarPosition
        )
    }

    /// Returns the states of the eight cells around the robot that a percept shows, clockwise from north; `None` if
    /// the sensor does not show them.
    pub fn cells_around(self, percept: &Percept) -> Option<[CellState; 8]> {
        let shows = self.begins_with_neighbours() && percept.width() >= neighbours::WIDTH;
        shows.then(|| neighbours::cells(percept))
    }

    /// Returns every percept that occurs in the middle of a free, non-goal cell of a maze, each
    /// once, in order.
    pub fn percepts(self, maze: &Maze) -> Vec<Percept> {
        let all = self.at_most_percepts(maze, usize::MAX);
        all.expect("no maze has that many cells")
    }

    /// Returns the same; `None` if there are more than `most`.
    pub fn at_most_percepts(self, maze: &Maze, most: usize) -> Option<Vec<Percept>> {
        let mut seen = HashSet::with_hasher(FixedState::default());
        let mut percepts = Vec::new();
        // In a hall, most cells have the same percept as the previous one.
        let mut before = None;
        for cell in maze.free_cells().filter(|&cell| !maze.is_goal(cell)) {
            let percept = self.perceive_at(maze, cell);
            if before.replace(percept) != Some(percept) && seen.insert(percept) {
                percepts.push(percept);
            }
            if percepts.len() > most {
                return None;
            }
        }
        percepts.sort_unstable();
        Some(percepts)
    }

    /// Returns true if no two cells of any maze have the same percept.
    pub fn tells_all_apart(self) -> bool {
        match self {
            Self::Neighbours | Self::Lidar => false,
            Self::Position | Self::NeighboursPosition | Self::LidarPosition => true,
        }
    }

    /// Returns the robot's current percept.
    pub fn perceive(self, view: &View<'_>) -> Percept {
        let percept = self.unflipped(view);
        view.flipped.map_or(percept, |flipped| {
            let bits = (0..percept.width()).map(|at| percept.bit(at) != flipped.bit(at));
            Percept::from_bits(bits).expect("the same number of bits")
        })
    }

    /// Returns the percept without observation noise.
    fn unflipped(self, view: &View<'_>) -> Percept {
        match view.sensed.filter(|_| self.is_sensed()) {
            Some(sensed) => self.sense(view.maze, &sensed.local_map),
            None => self.perceive_at(view.maze, view.cell),
        }
    }

    /// Returns the percept from what the robot observed. Percepts that are looked up show the eight
    /// cells around the robot, as a lidar does.
    pub fn sense(self, maze: &Maze, local: &LocalMap<'_>) -> Percept {
        if maze.is_from_map() {
            // As in a costmap: a layer from the map, and a layer from the scan.
            let is_open = |direction| {
                lidar::is_open(maze, local.cell, direction) && !local.is_blocked(maze, direction)
            };
            return self.by_lidar(&is_open, maze, local.cell);
        }
        let is_free = |direction: Direction| {
            let (east, south) = direction.offset();
            local.surroundings.is_free(east, -south)
        };
        let is_seen = |direction| lidar::is_seen(&is_free, direction);
        self.by_lidar(&is_seen, maze, local.cell)
    }

    /// Returns the percept of a robot with perfect sensors in the middle of a free cell.
    pub fn perceive_at(self, maze: &Maze, cell: Cell) -> Percept {
        match self {
            Self::Neighbours => neighbours::percept(maze, cell),
            Self::Position => position::percept(maze, cell),
            Self::NeighboursPosition => {
                neighbours::percept(maze, cell).followed_by(&position::percept(maze, cell))
            }
            Self::Lidar | Self::LidarPosition => {
                self.by_lidar(&lidar::perfect(maze, cell), maze, cell)
            }
        }
    }

    /// Returns a lidar percept, for open steps around a robot whose estimated cell is `cell`.
    fn by_lidar(self, is_open: lidar::IsOpen<'_>, maze: &Maze, cell: Cell) -> Percept {
        let around = lidar::around(is_open);
        match self == Self::LidarPosition {
            true => around.followed_by(&position::percept(maze, cell)),
            false => around,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maze(name: &str) -> Maze {
        let file = format!("{}/../../worlds/{name}.json", env!("CARGO_MANIFEST_DIR"));
        Maze::load(std::path::Path::new(&file)).unwrap()
    }

    #[test]
    fn sensors_that_begin_with_the_neighbours_show_them_in_every_cell() {
        let maze = maze("maze4");
        let first = |sensor: Sensor, cell| {
            let percept = sensor.perceive_at(&maze, cell);
            let width = percept.width().min(neighbours::WIDTH);
            (0..width).map(|at| percept.bit(at)).collect::<Vec<_>>()
        };
        for &sensor in Sensor::ALL {
            let shows = |model| {
                let mut cells = maze.free_cells();
                cells.all(|cell| first(sensor, cell) == first(model, cell))
            };
            let begins = shows(Sensor::Neighbours) || shows(Sensor::Lidar);
            assert_eq!(sensor.begins_with_neighbours(), begins, "{sensor:?}");
        }
        let sensor = Sensor::NeighboursPosition;
        for cell in maze.free_cells() {
            let shown = sensor.cells_around(&sensor.perceive_at(&maze, cell));
            assert_eq!(shown, Some(maze.around(cell)), "{cell:?}");
        }
    }

    /// The room is a square, so that its middle stays in place.
    #[test]
    fn rotating_the_ring_of_a_percept_matches_rotating_the_room() {
        let turned = |rows: [&str; 5]| -> [String; 5] {
            let column = |at: usize| rows.iter().rev().map(move |row| row.as_bytes()[at]);
            std::array::from_fn(|at| column(at).map(char::from).collect())
        };
        let room = ["#####", "#..S#", "#..##", "#G.##", "#####"];
        let at_middle = |sensor: Sensor, rows: &[String]| {
            let text = format!(r#"{{ "rows": {rows:?} }}"#);
            let maze = Maze::from_json(text.as_bytes(), "room.json").unwrap();
            sensor.perceive_at(&maze, Cell { col: 2, row: 2 })
        };
        let (upright, turned) = (room.map(str::to_owned), turned(room));
        let mut checked = 0;
        for &sensor in Sensor::ALL.iter().filter(|sensor| sensor.ring(4) > 0) {
            let ring = sensor.ring(4);
            let [before, after] = [&upright, &turned].map(|rows| at_middle(sensor, rows));
            let bits = |percept: Percept| (0..ring).map(|at| percept.bit(at)).collect::<Vec<_>>();
            let east_ahead = after.rotated(ring / 4, ring);
            assert_eq!(bits(east_ahead), bits(before), "{sensor:?}");
            assert_ne!(bits(after), bits(before), "control: {sensor:?}");
            checked += 1;
        }
        assert_eq!(checked, 4);
    }

    /// Returns true if a wall ahead looks the same to each of the moves, once the percept is
    /// rotated to the direction of the move. The only obstacle is a wall in that direction.
    fn shows_what_is_ahead(sensor: Sensor, moves: &[Direction], ring: usize) -> bool {
        let cell = Cell { col: 4, row: 4 };
        let ahead = |(action, way): (usize, &Direction)| {
            let (east, south) = way.offset();
            let mut rows = [*b"#########"; 9];
            rows[1..8].iter_mut().for_each(|row| *row = *b"#.......#");
            (rows[1][1], rows[7][7]) = (b'S', b'G');
            rows[(4 + south) as usize][(4 + east) as usize] = b'#';
            let rows = rows.map(|row| row.map(char::from).iter().collect::<String>());
            let text = format!(r#"{{ "rows": {rows:?} }}"#);
            let maze = Maze::from_json(text.as_bytes(), "room.json").unwrap();
            let percept = sensor.perceive_at(&maze, cell);
            let turned = percept.rotated(action * ring / moves.len(), ring);
            [0, 1].map(|bit| turned.bit(bit))
        };
        let mut all = moves.iter().enumerate().map(ahead);
        let first = all.next().unwrap();
        all.all(|one| one == first)
    }

    #[test]
    fn only_rings_with_an_equal_part_for_each_move_are_rotated() {
        for moves in [&Direction::MAIN[..], &Direction::CLOCKWISE] {
            for &sensor in Sensor::ALL {
                let ring = sensor.ring(moves.len());
                let fits = shows_what_is_ahead(sensor, moves, ring);
                assert!(fits || ring == 0, "{sensor:?}, {}", moves.len());
            }
        }
        let fits = shows_what_is_ahead(Sensor::Position, &Direction::MAIN, 4);
        assert!(!fits, "control: a position has no ring");
    }
}
