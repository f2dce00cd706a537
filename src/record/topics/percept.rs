//! `/scene/percept`: what the robot perceives of the eight cells around it, as frames around them.

use foxglove::messages::{LinePrimitive, Point3, SceneUpdate, line_primitive};
use nalgebra::{Point2, Vector2};

use super::rounded;
use super::scene::{WORLD, color, entity, place, point, update};
use crate::sensor::Sensor;
use crate::world::{Cell, Direction, Maze};
use xcs::Percept;

/// Colours of cells that are perceived as free, as a wall and as the goal.
const KINDS: [u32; 3] = [0x0a6fc2, 0xff8c1a, 0x22e06a];
/// How far a frame is from the middle of its cell, in cells (a fraction that takes few bytes), and how
/// high, above all walls.
const HALF: f64 = 27.0 / 64.0;
const HEIGHT: f64 = 0.28;
/// How thick its lines are, in cells.
const THICK: f64 = 0.045;

/// The frames around the cell in which the robot decides; none if it perceives no cells around.
pub(in crate::record) fn scene(
    sensor: Sensor,
    maze: &Maze,
    cell: Cell,
    percept: &Percept,
    time_ns: u64,
) -> SceneUpdate {
    let mut halo = entity("percept", WORLD, time_ns);
    if sensor.begins_with_neighbours() {
        let corners = corners(maze);
        let kinds = KINDS.iter().enumerate();
        let frames = kinds.map(|(kind, &rgb)| (rgb, edges(percept, kind)));
        let shown = frames.filter(|(_, edges)| !edges.is_empty());
        halo.lines = shown
            .map(|(rgb, edges)| frames_of(maze, cell, rgb, corners.clone(), edges))
            .collect();
    }
    update(vec![halo])
}

/// The corners of the frames of all eight cells, four for each, seen from the robot's cell: so
/// they are the same wherever it is and whatever it perceives, and compress well.
fn corners(maze: &Maze) -> Vec<Point3> {
    let unit = maze.cell_size_m();
    let framed = Direction::CLOCKWISE.iter().flat_map(|direction| {
        let (east, south) = direction.offset();
        let middle = Point2::new(f64::from(east), f64::from(-south)) * unit;
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| {
            let corner = middle + Vector2::new(x, y) * (HALF * unit);
            point(corner, 0.0)
        })
    });
    framed.collect()
}

/// The edges of the frames of all cells of a kind, as pairs of corners.
fn edges(percept: &Percept, kind: usize) -> Vec<u32> {
    let of_kind = (0..Direction::CLOCKWISE.len()).filter(|&at| perceived(percept, at) == kind);
    let edges = [0, 1, 1, 2, 2, 3, 3, 0];
    of_kind
        .flat_map(|cell| edges.map(|corner| 4 * cell as u32 + corner))
        .collect()
}

/// What the bits of cell `number` say: free, wall or goal, as an index into their colours.
fn perceived(percept: &Percept, number: usize) -> usize {
    match (percept.bit(2 * number), percept.bit(2 * number + 1)) {
        (true, _) => 2,
        (false, true) => 1,
        (false, false) => 0,
    }
}

fn frames_of(
    maze: &Maze,
    cell: Cell,
    rgb: u32,
    corners: Vec<Point3>,
    edges: Vec<u32>,
) -> LinePrimitive {
    let (at, unit) = (maze.centre_m(cell), maze.cell_size_m());
    LinePrimitive {
        r#type: line_primitive::Type::LineList as i32,
        pose: place(at.x, at.y, HEIGHT * unit),
        thickness: rounded(THICK * unit),
        scale_invariant: false,
        points: corners,
        color: color(rgb, 0.9),
        colors: Vec::new(),
        indices: edges,
    }
}
