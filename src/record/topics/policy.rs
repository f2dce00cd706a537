//! `/scene/policy`: the best actions of each cell, coloured by how near the goal is along the policy. The colour only
//! gets darker along a path to the goal.
//!
//! `/scene/values`: the ranks of the cells' values as columns, a landscape that a viewer can switch on.

use std::collections::BTreeMap;

use foxglove::messages::{Color, CubePrimitive, Point3, SceneUpdate, TriangleListPrimitive};
use nalgebra::{Point2, Vector2};

use super::rounded;
use super::scene::{WORLD, color, cube, entity, place, point, update, vector};
use crate::episode::PolicyMap;
use crate::picture::{NO_GOAL, SCALE};
use crate::world::{Cell, Direction, Maze};

/// Shares are told apart in so many steps, each a list of triangles in one colour.
const SHADES: f64 = 8.0;
/// An arrow is a dart on the floor, on which the robot drives. Its corners, ahead and to the left of
/// a cell's middle: tip, left, notch, right.
const DART: [[f64; 2]; DART_CORNERS] = [[15.0, 0.0], [4.0, 6.0], [7.0, 0.0], [4.0, -6.0]];
/// The corners are given in so many parts of a cell: such fractions take few bytes.
const PARTS: f64 = 32.0;
/// Points of an arrow, of which the first is its tip.
pub(in crate::record) const DART_CORNERS: usize = 4;
/// The two triangles of a dart, by its corners.
const TRIANGLES: [u32; 6] = [0, 1, 2, 0, 2, 3];
/// How high the floor's paint lies, in cells.
const PAINT: f64 = 0.02;
/// The greatest height of a column, in cells, and how wide it is.
const COLUMN: [f64; 2] = [1.2, 0.6875];

/// A cell that has arrows, their shade, and which actions are best, as bits.
pub(in crate::record) type Mark = (Cell, u8, u8);

/// What decides how the arrows look. All are the same when these are, which is known in a fraction
/// of the time that the arrows take.
pub(in crate::record) fn marks(policy: Option<&PolicyMap>, maze: &Maze) -> Vec<Mark> {
    let near = policy
        .into_iter()
        .flat_map(|p| p.cells().zip(p.nearness(maze)));
    let marks = near.map(|((cell, values), near)| {
        let best = values.best_actions();
        let bits = best.fold(0, |bits, action| bits | 1 << action.index());
        (*cell, shade(near), bits)
    });
    marks.filter(|(.., bits)| *bits != 0).collect()
}

/// A dart for each best action of each cell that knows one; several on ties.
pub(in crate::record) fn painted(
    policy: Option<&PolicyMap>,
    maze: &Maze,
) -> Vec<TriangleListPrimitive> {
    let mut darts: BTreeMap<u8, Vec<Point3>> = BTreeMap::new();
    let near = policy
        .into_iter()
        .flat_map(|p| p.cells().zip(p.nearness(maze)));
    for ((cell, values), near) in near {
        let best = values.best_actions();
        let mut best = best.filter_map(|action| maze.direction(action)).peekable();
        if best.peek().is_some() {
            let corners = darts.entry(shade(near)).or_default();
            corners.extend(best.flat_map(|direction| dart(maze, *cell, direction)));
        }
    }
    let darts = darts.into_iter();
    darts
        .map(|(shade, corners)| triangles(maze, shade, corners))
        .collect()
}

/// These arrows on the floor; none while nothing is known.
pub(in crate::record) fn scene(painted: Vec<TriangleListPrimitive>, time_ns: u64) -> SceneUpdate {
    let mut policy = entity("policy", WORLD, time_ns);
    policy.triangles = painted;
    update(vec![policy])
}

/// A column for each cell that knows what it is worth, as high as that ranks among all cells.
pub(in crate::record) fn columns(policy: Option<&PolicyMap>, maze: &Maze) -> Vec<CubePrimitive> {
    let unit = maze.cell_size_m();
    let ranked = policy.into_iter().flat_map(|p| p.cells().zip(p.ranks()));
    let columns = ranked.filter_map(|((cell, _), rank)| {
        let (at, high) = (maze.centre_in_grid(*cell), height(rank?) * unit);
        let size = vector(COLUMN[1] * unit, COLUMN[1] * unit, high);
        Some(cube(
            place(at.x, at.y, high / 2.0),
            size,
            colour(shade(rank), 0.85),
        ))
    });
    columns.collect()
}

/// How high a column of this rank is, in cells: in sixteenths, which take few bytes.
fn height(rank: f64) -> f64 {
    (16.0 * COLUMN[0] * (0.05 + rank)).round() / 16.0
}

/// These columns as a scene.
pub(in crate::record) fn landscape(columns: &[CubePrimitive], time_ns: u64) -> SceneUpdate {
    let mut landscape = entity("landscape", WORLD, time_ns);
    landscape.cubes = columns.to_vec();
    update(vec![landscape])
}

/// The corners of an arrow from the middle of a cell to its border.
fn dart(maze: &Maze, cell: Cell, direction: Direction) -> [Point3; DART_CORNERS] {
    let (unit, at) = (maze.cell_size_m(), maze.centre_in_grid(cell));
    let (east, south) = direction.offset();
    let ahead = Vector2::new(f64::from(east), f64::from(-south)).normalize();
    let left = Vector2::new(-ahead.y, ahead.x);
    DART.map(|[forth, aside]| {
        let corner: Point2<f64> = at + (ahead * forth + left * aside) * (unit / PARTS);
        point(corner, 0.0)
    })
}

fn triangles(maze: &Maze, shade: u8, corners: Vec<Point3>) -> TriangleListPrimitive {
    let darts = 0..corners.len() as u32 / 4;
    TriangleListPrimitive {
        pose: place(0.0, 0.0, PAINT * maze.cell_size_m()),
        points: corners,
        color: colour(shade, 1.0),
        colors: Vec::new(),
        indices: darts
            .flat_map(|dart| TRIANGLES.map(|corner| 4 * dart + corner))
            .collect(),
    }
}

/// The step of a share from 0 (far) to 1 (near), and one beyond these where there is none.
fn shade(share: Option<f64>) -> u8 {
    share.map_or(SHADES as u8 + 1, |share| (share * SHADES).round() as u8)
}

/// The colour of a step.
pub(super) fn colour(shade: u8, opacity: f64) -> Option<Color> {
    if f64::from(shade) > SHADES {
        return color(NO_GOAL, opacity);
    }
    let [far, middle, near] = SCALE.map(|rgb| color(rgb, 1.0).unwrap_or_default());
    let rank = f64::from(shade) / SHADES;
    let (from, to, share) = match rank < 0.5 {
        true => (far, middle, 2.0 * rank),
        false => (middle, near, 2.0 * rank - 1.0),
    };
    let blend = |from: f64, to: f64| rounded(from + (to - from) * share);
    Some(Color {
        r: blend(from.r, to.r),
        g: blend(from.g, to.g),
        b: blend(from.b, to.b),
        a: rounded(opacity),
    })
}
