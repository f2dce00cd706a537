//! `/values`: the learned values of each cell as a grid, which viewers colour.

use foxglove::messages::Grid;

use super::policy::is_large;
use super::scene::{GRID, place, timestamp};
use crate::event::Learned;
use xcscr_robot::world::Maze;

/// The height of the grid above the floor in a small and in a large maze, in cells. From afar,
/// viewers cannot distinguish a lower one from the floor.
const LIFT: [f64; 2] = [0.002, 0.01];

/// Creates the message.
pub(crate) fn grid(learned: &Learned, maze: &Maze, time_ns: u64) -> Grid {
    let lift_m = LIFT[usize::from(is_large(maze))] * maze.cell_size_m();
    Grid {
        timestamp: Some(timestamp(time_ns)),
        ..learned.grid(maze, GRID, place(0.0, 0.0, lift_m))
    }
}
