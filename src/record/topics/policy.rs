//! `/scene/policy`: the best actions of each cell, coloured by the distance to the goal along the
//! policy. The colour only gets darker along a path to the goal.

use std::collections::BTreeMap;

use foxglove::messages::{Color, Point3, SceneUpdate};
use nalgebra::{Point2, Vector2};

use super::rounded;
use super::scene::{GRID, color, entity, mixed, place, point, quads, update};
use crate::episode::PolicyMap;
use crate::picture::{NO_GOAL, SCALE};
use crate::world::{Cell, Direction, Maze};

/// The number of colour levels. Each level is a list of triangles in one colour.
const SHADES: f64 = 8.0;
/// An arrow is painted on the floor, on which the robot drives. Its corners, ahead and to the left
/// of a cell's middle: tip, left, notch, right.
const ARROW: [[f64; 2]; ARROW_CORNERS] = [[15.0, 0.0], [4.0, 6.0], [7.0, 0.0], [4.0, -6.0]];
/// The corners are multiples of this fraction of a cell, which take few bytes.
const PARTS: f64 = 32.0;
/// The number of corners of an arrow. The first one is its tip.
pub(in crate::record) const ARROW_CORNERS: usize = 4;
/// The height of the paint above the floor, in cells.
const PAINT: f64 = 0.02;

/// A cell with arrows, their shade, and its best actions as bits.
pub(in crate::record) type Mark = (Cell, u8, u8);

/// Returns the arrows: one for each best action of each cell with known values.
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

/// Creates the scene of the arrows; empty if no value is known.
pub(in crate::record) fn scene(marks: &[Mark], maze: &Maze, time_ns: u64) -> SceneUpdate {
    let mut arrows: BTreeMap<u8, Vec<Point3>> = BTreeMap::new();
    for &(cell, shade, bits) in marks {
        let directions = maze.moves().directions().iter().enumerate();
        let best = directions.filter(|(action, _)| bits >> action & 1 == 1);
        let corners = best.flat_map(|(_, direction)| arrow(maze, cell, *direction));
        arrows.entry(shade).or_default().extend(corners);
    }
    let mut policy = entity("policy", GRID, time_ns);
    let arrows = arrows.into_iter().map(|(shade, corners)| {
        let pose = place(0.0, 0.0, PAINT * maze.cell_size_m());
        quads(pose, corners, colour(shade, 1.0))
    });
    policy.triangles = arrows.collect();
    update(vec![policy])
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

/// Returns the level of a share from 0 (far) to 1 (near), and one beyond the levels if there is
/// none.
fn shade(share: Option<f64>) -> u8 {
    share.map_or(SHADES as u8 + 1, |share| (share * SHADES).round() as u8)
}

/// Returns the colour of a level.
pub(super) fn colour(shade: u8, opacity: f64) -> Color {
    let [far, middle, near] = SCALE.map(|rgb| color(rgb, 1.0));
    let rank = f64::from(shade) / SHADES;
    let colour = match 2.0 * rank {
        twice if twice > 2.0 => color(NO_GOAL, 1.0),
        twice if twice < 1.0 => mixed(far, middle, twice),
        twice => mixed(middle, near, twice - 1.0),
    };
    Color {
        a: rounded(opacity),
        ..colour
    }
}
