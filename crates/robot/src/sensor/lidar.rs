//! The bits of lidar percepts, from sensed surroundings or from a perfect lidar.
//!
//! All functions work on whole cells around the robot. Their input is a function that returns
//! whether a step from a cell to a neighbouring one is open. A lidar sees no goals. In a maze it
//! sees no hidden cells either: a diagonal neighbour between two walls counts as a wall.

use crate::world::{Cell, Direction, Maze};
use xcs::Percept;

/// Two bits for each of eight cells, as in the neighbours looked up in the maze.
pub const AROUND: usize = 16;
/// The largest number of free cells counted in each main direction ...
pub const FARTHEST: usize = 3;
/// ... with one bit for each, plus one bit for the diagonal clockwise of the direction.
pub const RANGES: usize = 4 * (FARTHEST + 1);
/// Sixteen beams of three bits.
pub const BEAMS: usize = 16 * BEAM_BITS;
/// The number of bits of a beam.
pub const BEAM_BITS: usize = 3;

/// Returns true if a step is open, from the cell at an offset to the east and to the north of the
/// robot, by a step to the east and to the north.
pub type IsOpen<'a> = &'a dyn Fn([i32; 2], [i32; 2]) -> bool;

/// Returns what a perfect lidar sees from the middle of a cell.
pub fn perfect(maze: &Maze, cell: Cell) -> impl Fn([i32; 2], [i32; 2]) -> bool + '_ {
    move |at, step| match maze.is_from_map() {
        true => is_open(maze, cell, at, step),
        false => is_seen(&|offset| is_free(maze, cell, offset), at, step),
    }
}

/// Returns true if a step from the cell at an offset of `cell` is open in a world from a map.
pub fn is_open(maze: &Maze, cell: Cell, at: [i32; 2], [east, north]: [i32; 2]) -> bool {
    let mut directions = Direction::CLOCKWISE.into_iter();
    let direction = directions.find(|direction| direction.offset() == (east, -north));
    let from = offset(maze, cell, at).filter(|&from| !maze.is_wall(from));
    from.zip(direction)
        .is_some_and(|(from, direction)| maze.is_open(from, direction))
}

/// Returns true if the cell at an offset of `cell` is free.
fn is_free(maze: &Maze, cell: Cell, at: [i32; 2]) -> bool {
    offset(maze, cell, at).is_some_and(|cell| !maze.is_wall(cell))
}

/// Returns the cell at an offset to the east and to the north of another.
fn offset(maze: &Maze, cell: Cell, [east, north]: [i32; 2]) -> Option<Cell> {
    let along = |from: u16, step: i32, size: u16| {
        let to = i32::from(from) + step;
        let size = i32::from(size);
        u16::try_from(if maze.wraps() {
            to.rem_euclid(size)
        } else {
            to
        })
        .ok()
    };
    Some(Cell {
        col: along(cell.col, east, maze.width())?,
        row: along(cell.row, -north, maze.height())?,
    })
}

/// Encodes the eight surrounding cells, clockwise from north: free `00`, wall or hidden `01`.
pub fn around(is_open: IsOpen<'_>) -> Percept {
    let bits = Direction::CLOCKWISE.iter().flat_map(|direction| {
        let (east, south) = direction.offset();
        [false, !is_open([0, 0], [east, -south])]
    });
    Percept::from_bits(bits).expect("sixteen bits fit")
}

/// Encodes each main direction, clockwise from north: whether one, two and three cells are free,
/// and whether the next diagonal cell clockwise is free.
pub fn ranges(is_open: IsOpen<'_>) -> Percept {
    let bits = (0..4).flat_map(|quarter| {
        let (east, south) = Direction::CLOCKWISE[2 * quarter].offset();
        let free = free_cells(is_open, &[[east, -south]], FARTHEST);
        let (beside, below) = Direction::CLOCKWISE[2 * quarter + 1].offset();
        let diagonal = is_open([0, 0], [beside, -below]);
        (1..=FARTHEST).map(move |far| far <= free).chain([diagonal])
    });
    Percept::from_bits(bits).expect("sixteen bits fit")
}

/// Encodes sixteen beams clockwise from north: the number of free cells that each passes through,
/// at most seven, highest bit first. The beams between the eight main ones go two cells along and
/// one across.
pub fn beams(is_open: IsOpen<'_>) -> Percept {
    let most = (1 << BEAM_BITS) - 1;
    let bits = (0..16).flat_map(|beam| {
        let free = free_cells(is_open, &strides(beam), most);
        (0..BEAM_BITS).rev().map(move |bit| free >> bit & 1 == 1)
    });
    Percept::from_bits(bits).expect("48 bits fit")
}

/// Returns the repeating pattern of steps from cell to cell along a beam.
fn strides(beam: usize) -> Vec<[i32; 2]> {
    let step = |eighth: usize| {
        let (east, south) = Direction::CLOCKWISE[eighth % 8].offset();
        [east, -south]
    };
    let (before, after) = (step(beam / 2), step(beam / 2 + 1));
    if beam.is_multiple_of(2) {
        return vec![before];
    }
    // One of the two steps is diagonal. The step across is the difference of the two.
    let is_main = |step: [i32; 2]| step.contains(&0);
    let (along, diagonal) = if is_main(before) {
        (before, after)
    } else {
        (after, before)
    };
    let across = [diagonal[0] - along[0], diagonal[1] - along[1]];
    // The beam passes through the side of the first cell, then into the cell across, and straight
    // on.
    vec![along, across, along]
}

/// Returns the number of cells that a beam passes through before it meets a wall.
fn free_cells(is_open: IsOpen<'_>, strides: &[[i32; 2]], most: usize) -> usize {
    let mut at = [0, 0];
    let passes = |stride: &&[i32; 2]| {
        let free = is_open(at, **stride);
        at = [at[0] + stride[0], at[1] + stride[1]];
        free
    };
    strides.iter().cycle().take(most).take_while(passes).count()
}

/// Returns true if the next cell of a maze is free, and not hidden behind the corner of two walls.
pub fn is_seen(
    is_free: &dyn Fn([i32; 2]) -> bool,
    [east, north]: [i32; 2],
    [x, y]: [i32; 2],
) -> bool {
    let hidden = x != 0 && y != 0 && !is_free([east + x, north]) && !is_free([east, north + y]);
    !hidden && is_free([east + x, north + y])
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: [&str; 6] = [
        "#######", "#S....#", "###.#.#", "#...#.#", "#.#..G#", "#######",
    ];

    fn maze() -> Maze {
        Maze::from_json(format!(r#"{{ "rows": {ROWS:?} }}"#).as_bytes(), "m").unwrap()
    }

    fn shown(percept: Percept, width: usize) -> Vec<String> {
        let text = percept.to_string();
        let letters: Vec<char> = text.chars().collect();
        letters
            .chunks(width)
            .map(|part| part.iter().collect())
            .collect()
    }

    #[test]
    fn lidar_neighbours_match_the_maze_except_for_goals_and_hidden_cells() {
        let maze = maze();
        let cell = Cell { col: 3, row: 2 };
        let percept = around(&perfect(&maze, cell));
        assert_eq!(shown(percept, 2).join(" "), "00 00 01 01 00 00 01 00");
        // South-east of (4, 4) is the border, north-east of it a free cell.
        let below = around(&perfect(&maze, Cell { col: 4, row: 4 }));
        assert_eq!(shown(below, 2).join(" "), "01 00 00 01 01 01 00 00");
    }

    #[test]
    fn a_diagonal_cell_between_two_walls_is_hidden() {
        let north_east = |free: &[[i32; 2]]| {
            let is_seen = |at, step| is_seen(&|cell| free.contains(&cell), at, step);
            !around(&is_seen).bit(3)
        };
        assert!(!north_east(&[[1, 1]]), "free, but between two walls");
        assert!(north_east(&[[1, 1], [1, 0]]));
        assert!(north_east(&[[1, 1], [0, 1]]));
        assert!(!north_east(&[[0, 1], [1, 0]]), "a wall");
    }

    #[test]
    fn ranges_count_free_cells_up_to_three() {
        let maze = maze();
        let percept = ranges(&perfect(&maze, Cell { col: 1, row: 1 }));
        assert_eq!(shown(percept, 4).join(" "), "0000 1110 0000 0000");
        let percept = ranges(&perfect(&maze, Cell { col: 5, row: 3 }));
        assert_eq!(shown(percept, 4).join(" "), "1100 0000 1001 0000");
    }

    #[test]
    fn beams_count_the_cells_that_they_go_through() {
        let maze = maze();
        let percept = beams(&perfect(&maze, Cell { col: 5, row: 1 }));
        let numbers: Vec<_> = shown(percept, 3)
            .iter()
            .map(|bits| usize::from_str_radix(bits, 2).unwrap())
            .collect();
        // Three cells to the south, four to the west; the beams next to them end in the second
        // cell.
        assert_eq!(numbers, [0, 0, 0, 0, 0, 0, 0, 1, 3, 1, 0, 1, 4, 1, 0, 0]);
    }

    #[test]
    fn a_beam_between_two_main_ones_takes_two_steps_along_and_one_across() {
        assert_eq!(strides(0), [[0, 1]]);
        assert_eq!(strides(1), [[0, 1], [1, 0], [0, 1]]);
        assert_eq!(strides(3), [[1, 0], [0, 1], [1, 0]]);
        assert_eq!(strides(15), [[0, 1], [-1, 0], [0, 1]]);
    }
}
