//! `/scene/percept`: the perceived-cells overlay, with a frame around each of the eight
//! neighbouring cells, and the estimated pose.

use foxglove::messages::{LinePrimitive, Point3, SceneEntity, SceneUpdate};
use nalgebra::Point2;
use strum::VariantArray;

use super::scene::{GRID, color, entity, indices_by_four, lines, place, square, update};
use crate::event::Decision;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, CellState, Direction, Maze};

/// The distance of a frame from the middle of its cell, in cells (a fraction that takes few bytes),
/// and its height above all walls.
const HALF: f64 = 27.0 / 64.0;
const HEIGHT: f64 = 0.28;
/// The thickness of its lines, in cells.
const THICK: f64 = 0.045;

/// Returns the colour of a perceived cell.
pub fn colour(kind: CellState) -> u32 {
    match kind {
        CellState::Free => 0x0a6fc2,
        CellState::Wall => 0xff8c1a,
        CellState::Goal => 0x22e06a,
    }
}

/// Creates the frames around the robot's cell. The result is empty if the sensor does not perceive
/// neighbouring cells.
pub(crate) fn perceived_cells(
    sensor: Sensor,
    maze: &Maze,
    decision: &Decision,
    time_ns: u64,
) -> SceneEntity {
    let mut perceived_cells = entity("percept", GRID, time_ns);
    let Some(around) = decision.perceived(sensor) else {
        return perceived_cells;
    };
    let cell = Cell {
        col: decision.col,
        row: decision.row,
    };
    let frames = CellState::VARIANTS
        .iter()
        .map(|&kind| (kind, corners(maze, &around, kind)));
    let shown = frames.filter(|(_, corners)| !corners.is_empty());
    perceived_cells.lines = shown
        .map(|(kind, corners)| frames_of(maze, cell, colour(kind), corners))
        .collect();
    perceived_cells
}

/// Creates the scene of the perceived cells and the estimated pose.
pub(crate) fn scene(perceived_cells: SceneEntity, estimate: Vec<SceneEntity>) -> SceneUpdate {
    update([vec![perceived_cells], estimate].concat())
}

/// Returns the corners of the frames of all cells of a kind, four for each. They are relative to
/// the robot's cell: they are the same for every position and compress well.
fn corners(maze: &Maze, cells: &[CellState; 8], kind: CellState) -> Vec<Point3> {
    let unit = maze.cell_size_m();
    let around = Direction::CLOCKWISE.iter().zip(cells);
    let of_kind = around.filter(|(_, perceived)| **perceived == kind);
    let framed = of_kind.flat_map(|(direction, _)| {
        let (east, south) = direction.offset();
        let middle = Point2::new(f64::from(east), f64::from(-south)) * unit;
        square(middle, HALF * unit)
    });
    framed.collect()
}

/// Creates the frames with these corners around a cell.
fn frames_of(maze: &Maze, cell: Cell, rgb: u32, corners: Vec<Point3>) -> LinePrimitive {
    let (at, unit) = (maze.centre_in_grid(cell), maze.cell_size_m());
    let pose = place(at.x, at.y, HEIGHT * unit);
    LinePrimitive {
        indices: indices_by_four(&corners, [0, 1, 1, 2, 2, 3, 3, 0]),
        ..lines(pose, THICK * unit, corners, color(rgb, 0.9))
    }
}
