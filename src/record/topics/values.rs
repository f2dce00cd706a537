//! `/values`: the greatest value of each cell as the colour of the floor.
//!
//! In a large maze, arrows are too small when the whole maze is in view. There the floor has the
//! colours of the arrows, and the greedy policy's path from the start is drawn.

use std::collections::{BTreeMap, BTreeSet};

use foxglove::messages::{Color, LinePrimitive, Point3, SceneUpdate, line_primitive};

use super::maze::FLOOR;
use super::policy;
use super::scene::{GRID, color, entity, lines, mixed, place, point, quads, square, update};
use crate::episode::PolicyMap;
use crate::world::{Cell, Maze};

/// Red below 0, blue above. The share that is mixed into the floor's colour shows the rank among
/// all cells, so that cells far from the goal differ, too.
const BAD: u32 = 0xf06a70;
const GOOD: u32 = 0x5aa9ff;
/// The shares of the least and of the greatest rank.
const SHARES: [f64; 2] = [0.08, 0.78];
/// The number of levels between these shares. Each level is a list of triangles in one colour.
const SHADES: f64 = 8.0;

/// Mazes with more columns or rows than this are large.
const LARGE: u16 = 12;
/// The share of an arrow's colour that is mixed into the floor's colour in a large maze.
const FIELD: f64 = 0.45;
/// The colour of the greedy path, its thickness as a share of the longer side, and its height in
/// cells.
const PATH: u32 = 0x22304a;
const THICK: f64 = 0.011;
const HIGH: f64 = 0.016;
/// The height of the colours in a small and in a large maze, in cells. From afar, viewers cannot
/// distinguish lower ones from the floor.
const LIFT: [f64; 2] = [0.002, 0.01];

/// The colour of a cell: whether its value is negative, and the level of its share.
type Tint = (bool, u8);

/// Returns the cells with known values and their colours; empty for a very large maze.
fn tints(policy: Option<&PolicyMap>, maze: &Maze) -> Vec<(Cell, Tint)> {
    let policy = policy.filter(|_| !maze.is_too_large());
    let ranked = policy.into_iter().flat_map(|p| p.cells().zip(p.ranks()));
    let known = ranked.filter_map(|((cell, values), rank)| {
        let is_bad = values.greatest()? < 0.0;
        let share = if is_bad { 1.0 - rank? } else { rank? };
        Some((*cell, (is_bad, (share * SHADES).round() as u8)))
    });
    known.collect()
}

/// The floor as it is shown: the cells' colours, and in a large maze the cells of the greedy path.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::record) struct Floor {
    tints: Vec<(Cell, Tint)>,
    path: Vec<Cell>,
}

impl Floor {
    /// Returns the floor of a learned policy.
    pub fn of(policy: Option<&PolicyMap>, maze: &Maze) -> Self {
        let start = maze
            .start()
            .filter(|_| is_large(maze) && !maze.is_too_large());
        let path = policy
            .zip(start)
            .map(|(policy, start)| policy.greedy_path(maze, start));
        Self {
            tints: tints(policy, maze),
            path: path.map_or_else(Vec::new, once_each),
        }
    }
}

/// Returns true if the maze is so large that arrows are too small when the whole maze is in view.
pub(in crate::record) fn is_large(maze: &Maze) -> bool {
    maze.width().max(maze.height()) > LARGE
}

/// Returns the cells up to the first repeated one, where the path begins to cycle.
fn once_each(path: Vec<Cell>) -> Vec<Cell> {
    let mut seen = BTreeSet::new();
    let new = |cell: &Cell| seen.insert((cell.col, cell.row));
    path.into_iter().take_while(new).collect()
}

/// Creates the scene of the coloured floor.
pub(in crate::record) fn scene(shown: &Floor, maze: &Maze, time_ns: u64) -> SceneUpdate {
    let mut corners: BTreeMap<Tint, Vec<Point3>> = BTreeMap::new();
    for &(cell, tint) in &shown.tints {
        let around = square(maze.centre_in_grid(cell), 0.5 * maze.cell_size_m());
        corners.entry(tint).or_default().extend(around);
    }
    let mut floor = entity("values", GRID, time_ns);
    let lift_m = LIFT[usize::from(is_large(maze))] * maze.cell_size_m();
    let squares = corners.into_iter().map(|(tint, corners)| {
        let pose = place(0.0, 0.0, lift_m);
        quads(pose, corners, colour(maze, tint))
    });
    floor.triangles = squares.collect();
    if let [_, _, ..] = shown.path[..] {
        floor.lines.push(path_line(&shown.path, maze));
    }
    update(vec![floor])
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

/// Returns the colour of a cell: in a large maze that of an arrow of its rank, otherwise red or
/// blue, mixed into the floor's colour.
fn colour(maze: &Maze, (is_bad, shade): Tint) -> Color {
    let floor = color(FLOOR, 1.0);
    if is_large(maze) {
        let shade = if is_bad { SHADES as u8 - shade } else { shade };
        return mixed(floor, policy::colour(shade, 1.0), FIELD);
    }
    let [least, greatest] = SHARES;
    let share = least + (greatest - least) * f64::from(shade) / SHADES;
    let rgb = if is_bad { BAD } else { GOOD };
    mixed(floor, color(rgb, 1.0), share)
}
