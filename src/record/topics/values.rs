//! `/values`: the greatest value of each cell as colour on the floor. In a large maze, whose arrows are
//! too small for who sees the whole of it, the colours are those of the arrows, and the way that the
//! greedy policy takes from the start is drawn.

use std::collections::{BTreeMap, BTreeSet};

use foxglove::messages::{
    Color, LinePrimitive, Point3, SceneUpdate, TriangleListPrimitive, line_primitive,
};
use nalgebra::Vector2;

use super::maze::FLOOR;
use super::scene::{WORLD, color, entity, place, point, update};
use super::{policy, rounded};
use crate::episode::PolicyMap;
use crate::world::{Cell, Maze};

/// Red below 0, blue above; how much of it is mixed with the floor's colour tells the rank among all
/// cells, so that cells far from the goal differ, too. What lets light through would be drawn over
/// the columns of the landscape.
const BAD: u32 = 0xf06a70;
const GOOD: u32 = 0x5aa9ff;
/// The shares of the least and of the greatest rank ...
const SHARES: [f64; 2] = [0.08, 0.78];
/// ... between which so many steps are told apart, each a list of triangles in one colour.
const SHADES: f64 = 8.0;
/// The corners of a cell, seen from its middle, and the two triangles between them.
const CORNERS: [[f64; 2]; 4] = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
const TRIANGLES: [u32; 6] = [0, 1, 2, 0, 2, 3];

/// Mazes with more columns or rows than this are large.
const LARGE: u16 = 12;
/// The share of an arrow's colour that is mixed with that of the floor of a large maze.
const FIELD: f64 = 0.45;
/// The colour of the greedy way, how thick it is as a share of the longer side, and how high it lies,
/// in cells.
const WAY: u32 = 0x22304a;
const THICK: f64 = 0.011;
const HIGH: f64 = 0.016;
/// How high the colours lie in a small and in a large maze, in cells: from afar, viewers cannot tell
/// what lies so low from the floor.
const LIFT: [f64; 2] = [0.002, 0.01];

/// How a cell is coloured: worth less than nothing or not, and the step of its share.
type Tint = (bool, u8);

/// The cells whose value is known, and how they are coloured; none of a vast maze.
fn tints(policy: Option<&PolicyMap>, maze: &Maze) -> Vec<(Cell, Tint)> {
    let policy = policy.filter(|_| !maze.is_vast());
    let ranked = policy.into_iter().flat_map(|p| p.cells().zip(p.ranks()));
    let known = ranked.filter_map(|((cell, values), rank)| {
        let is_bad = values.greatest()? < 0.0;
        let share = if is_bad { 1.0 - rank? } else { rank? };
        Some((*cell, (is_bad, (share * SHADES).round() as u8)))
    });
    known.collect()
}

/// The floor as it is shown: the cells' colours, and in a large maze the cells of the greedy way.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::record) struct Floor {
    tints: Vec<(Cell, Tint)>,
    way: Vec<Cell>,
}

impl Floor {
    /// That of what was learned.
    pub fn of(policy: Option<&PolicyMap>, maze: &Maze) -> Self {
        let start = maze.start().filter(|_| is_large(maze) && !maze.is_vast());
        let way = policy
            .zip(start)
            .map(|(policy, start)| policy.greedy_path(maze, start));
        Self {
            tints: tints(policy, maze),
            way: way.map_or_else(Vec::new, once_each),
        }
    }
}

/// Is it so large that arrows are too small for who sees the whole of it?
pub(in crate::record) fn is_large(maze: &Maze) -> bool {
    maze.width().max(maze.height()) > LARGE
}

/// The cells up to the first that comes again: there the way goes in circles.
fn once_each(way: Vec<Cell>) -> Vec<Cell> {
    let mut seen = BTreeSet::new();
    let new = |cell: &Cell| seen.insert((cell.col, cell.row));
    way.into_iter().take_while(new).collect()
}

/// The coloured floor.
pub(in crate::record) fn scene(shown: &Floor, maze: &Maze, time_ns: u64) -> SceneUpdate {
    let mut corners: BTreeMap<Tint, Vec<Point3>> = BTreeMap::new();
    for &(cell, tint) in &shown.tints {
        let (unit, at) = (maze.cell_size_m(), maze.centre_in_grid(cell));
        let around = CORNERS.map(|[x, y]| point(at + Vector2::new(x, y) * unit, 0.0));
        corners.entry(tint).or_default().extend(around);
    }
    let mut floor = entity("values", WORLD, time_ns);
    let corners = corners.into_iter();
    floor.triangles = corners
        .map(|(tint, corners)| squares(maze, tint, corners))
        .collect();
    if let [_, _, ..] = shown.way[..] {
        floor.lines.push(way(&shown.way, maze));
    }
    update(vec![floor])
}

/// A line through the middles of cells.
fn way(cells: &[Cell], maze: &Maze) -> LinePrimitive {
    let unit = maze.cell_size_m();
    let side_m = f64::from(maze.width().max(maze.height())) * unit;
    let middles = cells
        .iter()
        .map(|&cell| point(maze.centre_in_grid(cell), 0.0));
    LinePrimitive {
        r#type: line_primitive::Type::LineStrip as i32,
        pose: place(0.0, 0.0, HIGH * unit),
        thickness: rounded(THICK * side_m),
        scale_invariant: false,
        points: middles.collect(),
        color: color(WAY, 1.0),
        ..LinePrimitive::default()
    }
}

fn squares(maze: &Maze, (is_bad, shade): Tint, corners: Vec<Point3>) -> TriangleListPrimitive {
    let squares = 0..corners.len() as u32 / 4;
    TriangleListPrimitive {
        pose: place(
            0.0,
            0.0,
            LIFT[usize::from(is_large(maze))] * maze.cell_size_m(),
        ),
        points: corners,
        color: Some(match is_large(maze) {
            true => field(if is_bad { SHADES as u8 - shade } else { shade }),
            false => of_share(if is_bad { BAD } else { GOOD }, shade),
        }),
        colors: Vec::new(),
        indices: squares
            .flat_map(|square| TRIANGLES.map(|corner| 4 * square + corner))
            .collect(),
    }
}

/// The floor's colour with the more of another in it, the greater the shade.
fn of_share(rgb: u32, shade: u8) -> Color {
    let [least, greatest] = SHARES;
    let share = least + (greatest - least) * f64::from(shade) / SHADES;
    mixed(color(rgb, 1.0).unwrap_or_default(), share)
}

/// The floor's colour with some of that of an arrow of this rank in it.
fn field(shade: u8) -> Color {
    mixed(policy::colour(shade, 1.0).unwrap_or_default(), FIELD)
}

fn mixed(full: Color, share: f64) -> Color {
    let floor = color(FLOOR, 1.0).unwrap_or_default();
    let mix = |floor: f64, full: f64| rounded(floor + (full - floor) * share);
    Color {
        r: mix(floor.r, full.r),
        g: mix(floor.g, full.g),
        b: mix(floor.b, full.b),
        a: 1.0,
    }
}
