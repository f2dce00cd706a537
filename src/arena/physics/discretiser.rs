//! From where the robot sees itself to the cell it believes to stand in.

use nalgebra::Point2;

use crate::world::{Cell, Maze};

/// The cell that holds a measured position, in metres of the world frame.
///
/// A robot does not stand in a wall: a measurement that says so, or that lies outside of the
/// maze, is an outlier, and the robot goes on believing what it `believed` before.
pub(super) fn cell_from_position(maze: &Maze, measured_m: Point2<f64>, believed: Cell) -> Cell {
    maze.cell_at(measured_m)
        .filter(|&cell| !maze.is_wall(cell))
        .unwrap_or(believed)
}
