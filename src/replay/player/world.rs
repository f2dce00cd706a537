//! The maze of a page.

use serde::Serialize;

use crate::world::{Direction, Maze};

/// The maze as seen from above.
#[derive(Debug, Default, Serialize)]
pub struct World {
    width: u16,
    height: u16,
    cell_size_m: f64,
    /// The pose of the grid frame in the map frame: metres and radians.
    origin: [f64; 3],
    /// `#` wall, `S` start, `G` goal, `.` free; the northern row first.
    rows: Vec<String>,
    /// The cells to the east and to the north that each action leads to.
    moves: Vec<[i16; 2]>,
    /// The same for the eight cells around a cell, clockwise from north.
    around: Vec<[i16; 2]>,
}

impl World {
    /// Returns the maze as the page shows it.
    pub fn of(maze: &Maze) -> Self {
        let origin = maze.origin();
        let sign = |at| match maze.start() == Some(at) {
            true => 'S',
            false if maze.is_goal(at) => 'G',
            false if maze.is_wall(at) => '#',
            false => '.',
        };
        let cells: Vec<char> = maze.cells().map(sign).collect();
        let rows = cells.chunks(usize::from(maze.width()));
        Self {
            width: maze.width(),
            height: maze.height(),
            cell_size_m: maze.cell_size_m(),
            origin: [origin.x_m, origin.y_m, origin.yaw_rad],
            rows: rows.map(|row| row.iter().collect()).collect(),
            moves: offsets(maze.moves().directions()),
            around: offsets(&Direction::CLOCKWISE),
        }
    }
}

fn offsets(directions: &[Direction]) -> Vec<[i16; 2]> {
    let offset = |direction: &Direction| {
        let (east, south) = direction.offset();
        [east as i16, -(south as i16)]
    };
    directions.iter().map(offset).collect()
}
