//! From where the robot sees itself to the cell it believes to stand in.

use nalgebra::Point2;

use crate::world::{Cell, Maze};

/// The cell that holds a measured position, in metres of the grid frame.
///
/// A robot does not stand in a wall: a measurement that says so, or that lies outside of the
/// maze, is an outlier, and the robot goes on believing what it `believed` before.
pub(super) fn cell_from_position(maze: &Maze, measured_m: Point2<f64>, believed: Cell) -> Cell {
    maze.cell_in_grid(measured_m)
        .filter(|&cell| !maze.is_wall(cell))
        .unwrap_or(believed)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOME: Cell = Cell { col: 1, row: 1 };
    const NEXT: Cell = Cell { col: 2, row: 1 };

    fn believes(x_m: f64, y_m: f64) -> Cell {
        let rows = ["####", "#SG#", "####"];
        let text = format!(r#"{{ "cell_size_m": 2, "rows": {rows:?} }}"#);
        let maze = Maze::from_json(text.as_bytes(), "pair.json").unwrap();
        cell_from_position(&maze, Point2::new(x_m, y_m), HOME)
    }

    #[test]
    fn the_cell_is_the_one_that_holds_the_point() {
        assert_eq!(believes(3.99, 3.0), HOME);
        assert_eq!(believes(4.01, 3.0), NEXT);
        assert_eq!(believes(5.99, 2.01), NEXT);
    }

    #[test]
    fn a_measurement_in_a_wall_or_outside_changes_no_belief() {
        assert_eq!(believes(6.01, 3.0), HOME);
        assert_eq!(believes(-50.0, 3.0), HOME);
        assert_eq!(believes(f64::NAN, 3.0), HOME);
    }
}
