//! `/scene/policy`: the best actions of each cell, coloured by the distance to the goal along the
//! policy. The colour only gets darker along a path to the goal.

use std::collections::BTreeMap;

use foxglove::messages::{Color, LinePrimitive, Point3, SceneUpdate, line_primitive};
use nalgebra::{Point2, Vector2};

use super::scene::{GRID, color, entity, lines, mixed, place, point, quads, update};
use crate::colours::{NO_GOAL, SCALE};
use crate::event::Learned;
use xcscr_robot::world::{Cell, Direction, Maze};

/// The number of colour levels. Each level is a list of triangles in one colour.
const SHADES: f64 = 8.0;
/// An arrow is painted on the floor, on which the robot drives. Its corners, ahead and to the left
/// of a cell's middle: tip, left, notch, right.
const ARROW: [[f64; 2]; ARROW_CORNERS] = [[15.0, 0.0], [4.0, 6.0], [7.0, 0.0], [4.0, -6.0]];
/// The corners are multiples of this fraction of a cell, which take few bytes.
const PARTS: f64 = 32.0;
const ARROW_CORNERS: usize = 4;
/// The height of the paint above the floor, in cells.
const PAINT: f64 = 0.02;

/// Mazes with more columns or rows than this are large. There, arrows are too small when the whole
/// maze is in view, and the path of the greedy policy from the start is drawn.
const LARGE: u16 = 12;
/// The colour of the greedy path, its thickness as a share of the longer side, and its height in
/// cells.
const PATH: u32 = 0x22304a;
const THICK: f64 = 0.011;
const HIGH: f64 = 0.016;

/// Returns what the arrows show: each cell with its best actions and their shade.
pub(crate) fn marks(learned: &Learned) -> Vec<(Cell, u8, u8)> {
    let cells = learned.cells.iter();
    cells
        .map(|at| (at.cell, shade(at.nearness), at.best))
        .collect()
}

/// Creates the scene of the arrows; empty if no value is known.
pub(crate) fn scene(learned: &Learned, maze: &Maze, time_ns: u64) -> SceneUpdate {
    let mut arrows: BTreeMap<u8, Vec<Point3>> = BTreeMap::new();
    for at in &learned.cells {
        let directions = maze.moves().directions().iter().enumerate();
        let best = directions.filter(|(action, _)| at.best >> action & 1 == 1);
        let corners = best.flat_map(|(_, direction)| arrow(maze, at.cell, *direction));
        arrows
            .entry(shade(at.nearness))
            .or_default()
            .extend(corners);
    }
    let mut policy = entity("policy", GRID, time_ns);
    let arrows = arrows.into_iter().map(|(shade, corners)| {
        let pose = place(0.0, 0.0, PAINT * maze.cell_size_m());
        quads(pose, corners, colour(shade))
    });
    policy.triangles = arrows.collect();
    let start = maze
        .start()
        .filter(|_| is_large(maze) && !maze.is_too_large());
    let path = start.map(|start| learned.greedy_path(maze, start));
    policy.lines = path
        .filter(|path| path.len() > 1)
        .map(|path| path_line(&path, maze))
        .into_iter()
        .collect();
    update(vec![policy])
}

/// Returns true if the maze is so large that arrows are too small when the whole maze is in view.
pub(crate) fn is_large(maze: &Maze) -> bool {
    maze.width().max(maze.height()) > LARGE
}

/// Creates a line through the middles of cells.
fn path_line(cells: &[Cell], maze: &Maze) -> LinePrimitive {
    let unit = maze.cell_size_m();
    let side_m = f64::from(maze.width().max(maze.height())) * unit;
    let middles = cells
        .iter()
        .map(|&cell| point(maze.centre_in_grid(cell), 0.0));
    let (pose, points) = (place(0.0, 0.0, HIGH * unit), middles.collect());
    LinePrimitive {
        r#type: line_primitive::Type::LineStrip as i32,
        ..lines(pose, THICK * side_m, points, color(PATH, 1.0))
    }
}

/// Returns the corners of an arrow from the middle of a cell to its border.
fn arrow(maze: &Maze, cell: Cell, direction: Direction) -> [Point3; ARROW_CORNERS] {
    let (unit, at) = (maze.cell_size_m(), maze.centre_in_grid(cell));
    let (east, south) = direction.offset();
    let ahead = Vector2::new(f64::from(east), f64::from(-south)).normalize();
    let left = Vector2::new(-ahead.y, ahead.x);
    ARROW.map(|[forward, sideways]| {
        let corner: Point2<f64> = at + (ahead * forward + left * sideways) * (unit / PARTS);
        point(corner, 0.0)
    })
}

/// Returns the level of a nearness, and one beyond the levels for 0, which leads to no goal.
fn shade(nearness: f32) -> u8 {
    if nearness > 0.0 {
        (f64::from(nearness) * SHADES).round() as u8
    } else {
        SHADES as u8 + 1
    }
}

/// Returns the colour of a level.
fn colour(shade: u8) -> Color {
    let [far, middle, near] = SCALE.map(|rgb| color(rgb, 1.0));
    let rank = f64::from(shade) / SHADES;
    match 2.0 * rank {
        twice if twice > 2.0 => color(NO_GOAL, 1.0),
        twice if twice < 1.0 => mixed(far, middle, twice),
        twice => mixed(middle, near, twice - 1.0),
    }
}
