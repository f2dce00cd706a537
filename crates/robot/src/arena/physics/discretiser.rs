//! Converts the measured position to the estimated cell.

use nalgebra::Point2;

use crate::world::{Cell, Maze};

/// Returns the cell that contains a measured position, in metres of the grid frame.
///
/// The robot cannot be inside a wall. A measurement inside a wall or outside the maze is an
/// outlier, and the cell stays at `estimated`.
pub(super) fn cell_from_position(maze: &Maze, measured_m: Point2<f64>, estimated: Cell) -> Cell {
    maze.cell_in_grid(measured_m)
        .filter(|&cell| !maze.is_wall(cell))
        .unwrap_or(estimated)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOME: Cell = Cell { col: 1, row: 1 };
    const NEXT: Cell = Cell { col: 2, row: 1 };

    fn estimate(x_m: f64, y_m: f64) -> Cell {
        let rows = ["####", "#SG#", "####"];
        let text = format!(r#"{{ "cell_size_m": 2, "rows": {rows:?} }}"#);
        let maze = Maze::from_json(text.as_bytes(), "pair.json").unwrap();
        cell_from_position(&maze, Point2::new(x_m, y_m), HOME)
    }

    #[test]
    fn the_cell_contains_the_point() {
        assert_eq!(estimate(3.99, 3.0), HOME);
        assert_eq!(estimate(4.01, 3.0), NEXT);
        assert_eq!(estimate(5.99, 2.01), NEXT);
    }

    #[test]
    fn a_measurement_in_a_wall_or_outside_does_not_change_the_estimate() {
        assert_eq!(estimate(6.01, 3.0), HOME);
        assert_eq!(estimate(-50.0, 3.0), HOME);
        assert_eq!(estimate(f64::NAN, 3.0), HOME);
    }
}
