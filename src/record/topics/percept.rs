//! `/scene/percept`: what the robot perceives of the eight cells around it, as frames around them, and
//! where it believes to be.

use foxglove::messages::{LinePrimitive, Point3, SceneEntity, SceneUpdate, line_primitive};
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
pub(in crate::record) fn halo(
    sensor: Sensor,
    maze: &Maze,
    cell: Cell,
    percept: &Percept,
    time_ns: u64,
) -> SceneEntity {
    let mut halo = entity("percept", WORLD, time_ns);
    if sensor.begins_with_neighbours() {
        halo.lines = vec![frames(maze, cell, percept)];
    }
    halo
}

/// What the robot perceives and believes.
pub(in crate::record) fn scene(halo: SceneEntity, belief: &[SceneEntity]) -> SceneUpdate {
    let mut entities = vec![halo];
    entities.extend_from_slice(belief);
    update(entities)
}

fn frames(maze: &Maze, cell: Cell, percept: &Percept) -> LinePrimitive {
    let (at, unit) = (maze.centre_m(cell), maze.cell_size_m());
    let kinds = (0..Direction::CLOCKWISE.len()).map(|number| perceived(percept, number));
    let colors = kinds.flat_map(|kind| [color(KINDS[kind], 0.9).unwrap_or_default(); 4]);
    let edges = [0, 1, 1, 2, 2, 3, 3, 0];
    let cells = 0..Direction::CLOCKWISE.len() as u32;
    LinePrimitive {
        r#type: line_primitive::Type::LineList as i32,
        pose: place(at.x, at.y, HEIGHT * unit),
        thickness: rounded(THICK * unit),
        scale_invariant: false,
        points: corners(maze),
        color: None,
        colors: colors.collect(),
        indices: cells
            .flat_map(|cell| edges.map(|corner| 4 * cell + corner))
            .collect(),
    }
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

/// What the bits of cell `number` say: free, wall or goal, as an index into their colours.
fn perceived(percept: &Percept, number: usize) -> usize {
    match (percept.bit(2 * number), percept.bit(2 * number + 1)) {
        (true, _) => 2,
        (false, true) => 1,
        (false, false) => 0,
    }
}
