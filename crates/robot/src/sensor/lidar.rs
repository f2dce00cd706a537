//! The bits of lidar percepts, from sensed surroundings or from a perfect lidar.
//!
//! A lidar percept shows whether the steps to the eight cells around the robot are open. A lidar sees no goals. In
//! a maze it sees no hidden cells either: a diagonal neighbour between two walls counts as a wall.

use crate::world::{Cell, Direction, Maze};
use xcs::Percept;

/// Two bits for each of eight cells, as in the neighbours looked up in the maze.
pub const AROUND: usize = 16;

/// Returns true if the step to a neighbouring cell is open.
pub type IsOpen<'a> = &'a dyn Fn(Direction) -> bool;

/// Returns what a perfect lidar sees from the middle of a cell.
pub fn perfect(maze: &Maze, cell: Cell) -> impl Fn(Direction) -> bool + '_ {
    let is_free = move |direction| {
        let next = maze.neighbour(cell, direction);
        next.is_some_and(|next| !maze.is_wall(next))
    };
    move |direction| match maze.is_from_map() {
        true => is_open(maze, cell, direction),
        false => is_seen(&is_free, direction),
    }
}

/// Returns true if the step from a cell is open in a world from a map.
pub fn is_open(maze: &Maze, cell: Cell, direction: Direction) -> bool {
    !maze.is_wall(cell) && maze.is_open(cell, direction)
}

/// Encodes the eight surrounding cells, clockwise from north: free `00`, wall or hidden `01`.
pub fn around(is_open: IsOpen<'_>) -> Percept {
    let bits = Direction::CLOCKWISE
        .iter()
        .flat_map(|&direction| [false, !is_open(direction)]);
    Percept::from_bits(bits).expect("sixteen bits fit")
}

/// Returns true if the next cell of a maze is free, and not hidden behind the corner of two walls.
pub fn is_seen(is_free: IsOpen<'_>, direction: Direction) -> bool {
    let hidden = direction
        .sides()
        .is_some_and(|sides| !sides.into_iter().any(is_free));
    !hidden && is_free(direction)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(percept: Percept) -> String {
        let text = percept.to_string();
        let letters: Vec<char> = text.chars().collect();
        let pairs: Vec<String> = letters
            .chunks(2)
            .map(|pair| pair.iter().collect())
            .collect();
        pairs.join(" ")
    }

    #[test]
    fn lidar_neighbours_match_the_maze_except_for_goals_and_hidden_cells() {
        let rows = [
            "#######", "#S....#", "###.#.#", "#...#.#", "#.#..G#", "#######",
        ];
        let maze = Maze::from_json(format!(r#"{{ "rows": {rows:?} }}"#).as_bytes(), "m").unwrap();
        let cell = Cell { col: 3, row: 2 };
        let percept = around(&perfect(&maze, cell));
        assert_eq!(shown(percept), "00 00 01 01 00 00 01 00");
        // South-east of (4, 4) is the border, north-east of it a free cell.
        let below = around(&perfect(&maze, Cell { col: 4, row: 4 }));
        assert_eq!(shown(below), "01 00 00 01 01 01 00 00");
    }

    #[test]
    fn a_diagonal_cell_between_two_walls_is_hidden() {
        use Direction::{East, North, NorthEast};
        let north_east = |free: &[Direction]| {
            let is_seen = |direction| is_seen(&|way| free.contains(&way), direction);
            !around(&is_seen).bit(3)
        };
        assert!(!north_east(&[NorthEast]), "free, but between two walls");
        assert!(north_east(&[NorthEast, East]));
        assert!(north_east(&[NorthEast, North]));
        assert!(!north_east(&[North, East]), "a wall");
    }
}
