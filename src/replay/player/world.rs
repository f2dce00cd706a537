//! The maze of a page.

use serde::Serialize;

use crate::world::{Block, Direction, Maze};

/// The most blocks of walls on a page.
const MOST_BLOCKS: usize = 1 << 14;

/// The maze as seen from above.
#[derive(Debug, Default, Serialize)]
pub struct World {
    width: u16,
    height: u16,
    cell_size_m: f64,
    /// The pose of the grid frame in the map frame: metres and radians.
    origin: [f64; 3],
    /// The true shape of the walls in a world from a map; without it, the walls fill their cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    walls: Option<Walls>,
    /// `#` wall, `S` start, `G` goal, `.` free; the northern row first.
    rows: Vec<String>,
    /// The cells to the east and to the north that each action leads to.
    moves: Vec<[i16; 2]>,
    /// The same for the eight cells around a cell, clockwise from north.
    around: Vec<[i16; 2]>,
}

/// The walls of a world from a map. Everything outside of their rectangle is solid.
#[derive(Debug, Serialize)]
struct Walls {
    /// The pose of the lower left corner in the grid frame: metres and radians.
    corner: [f64; 3],
    /// Width and height in metres.
    size_m: [f64; 2],
    /// For each solid block: the distances of its left and lower sides from those of the rectangle,
    /// its width and its height, in pixels.
    blocks: Vec<[usize; 4]>,
    pixel_m: f64,
}

impl Walls {
    /// Returns the walls; `None` in a maze, and for more blocks than a page can show.
    fn of(maze: &Maze) -> Option<Self> {
        let solid = maze.solid();
        let [width, height] = solid.size();
        let blocks = maze.is_from_map().then(|| solid.blocks())?;
        let corner = solid.corner_in_grid().copied().unwrap_or_default();
        let at = corner.translation.vector;
        let place = |block: &Block| {
            let below = height - block.row - block.height;
            [block.col, below, block.width, block.height]
        };
        (blocks.len() <= MOST_BLOCKS).then(|| Self {
            corner: [at.x, at.y, corner.rotation.angle()],
            size_m: [width, height].map(|pixels| pixels as f64 * solid.pixel_m()),
            blocks: blocks.iter().map(place).collect(),
            pixel_m: solid.pixel_m(),
        })
    }
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
            walls: Walls::of(maze),
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
