//! `/worth`: the greatest worth of each cell as colour on the floor.

use std::collections::BTreeMap;

use foxglove::messages::{Color, Point3, SceneUpdate, TriangleListPrimitive};
use nalgebra::Vector2;

use super::maze::FLOOR;
use super::rounded;
use super::scene::{WORLD, color, entity, place, point, update};
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

/// How a cell is coloured: worth less than nothing or not, and the step of its share.
pub(in crate::record) type Tint = (bool, u8);

/// The cells whose worth is known, and how they are coloured; none of a vast maze.
pub(in crate::record) fn tints(policy: Option<&PolicyMap>, maze: &Maze) -> Vec<(Cell, Tint)> {
    let policy = policy.filter(|_| !maze.is_vast());
    let ranked = policy.into_iter().flat_map(|p| p.cells().zip(p.ranks()));
    let known = ranked.filter_map(|((cell, worth), rank)| {
        let is_bad = worth.greatest()? < 0.0;
        let share = if is_bad { 1.0 - rank? } else { rank? };
        Some((*cell, (is_bad, (share * SHADES).round() as u8)))
    });
    known.collect()
}

/// The coloured floor.
pub(in crate::record) fn scene(tints: &[(Cell, Tint)], maze: &Maze, time_ns: u64) -> SceneUpdate {
    let mut corners: BTreeMap<Tint, Vec<Point3>> = BTreeMap::new();
    for &(cell, tint) in tints {
        let (unit, at) = (maze.cell_size_m(), maze.centre_m(cell));
        let around = CORNERS.map(|[x, y]| point(at + Vector2::new(x, y) * unit, 0.0));
        corners.entry(tint).or_default().extend(around);
    }
    let mut floor = entity("worth", WORLD, time_ns);
    let corners = corners.into_iter();
    floor.triangles = corners
        .map(|(tint, corners)| squares(maze, tint, corners))
        .collect();
    update(vec![floor])
}

fn squares(maze: &Maze, (is_bad, shade): Tint, corners: Vec<Point3>) -> TriangleListPrimitive {
    let squares = 0..corners.len() as u32 / 4;
    TriangleListPrimitive {
        pose: place(0.0, 0.0, 0.002 * maze.cell_size_m()),
        points: corners,
        color: Some(mixed(if is_bad { BAD } else { GOOD }, shade)),
        colors: Vec::new(),
        indices: squares
            .flat_map(|square| TRIANGLES.map(|corner| 4 * square + corner))
            .collect(),
    }
}

/// The floor's colour with so much of another in it.
fn mixed(rgb: u32, shade: u8) -> Color {
    let [least, greatest] = SHARES;
    let share = least + (greatest - least) * f64::from(shade) / SHADES;
    let [floor, full] = [FLOOR, rgb].map(|rgb| color(rgb, 1.0).unwrap_or_default());
    let mix = |floor: f64, full: f64| rounded(floor + (full - floor) * share);
    Color {
        r: mix(floor.r, full.r),
        g: mix(floor.g, full.g),
        b: mix(floor.b, full.b),
        a: 1.0,
    }
}
