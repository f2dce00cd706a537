//! `/scene/policy`: the best actions of each cell, coloured by the rank of their worth among all
//! cells (the paper's figure 5): a scale that tells cells apart however far the goal is.

use foxglove::messages::{ArrowPrimitive, Color, Pose, SceneUpdate};
use nalgebra::{Complex, UnitComplex};

use super::rounded;
use super::scene::{WORLD, color, entity, heading, update, vector};
use crate::episode::PolicyMap;
use crate::world::{Cell, Direction, Maze};

/// The colours of the least worth, of the median and of the greatest: red, yellow, green.
const SCALE: [u32; 3] = [0xe0322f, 0xf2b632, 0x1f9d55];
/// Where an arrow begins and how long its two parts are, in cells: from beside the robot, which
/// stands in the middle of a cell, to the border.
const TAIL: f64 = 0.29;
const SHAFT: f64 = 0.06;
const HEAD: f64 = 0.14;

/// An arrow for each best action of each cell that knows one; several on ties.
pub(in crate::record) fn scene(policy: &PolicyMap, maze: &Maze, time_ns: u64) -> SceneUpdate {
    let ranks = policy.ranks();
    let mut arrows = entity("policy", WORLD, time_ns);
    for ((cell, worth), rank) in policy.cells().zip(ranks) {
        let best = worth.best_actions();
        let best = best.filter_map(|action| maze.direction(action));
        let colour = shade(rank.unwrap_or(0.0));
        arrows
            .arrows
            .extend(best.map(|direction| arrow(maze, *cell, direction, colour)));
    }
    update(vec![arrows])
}

/// No policy yet.
pub(in crate::record) fn empty(time_ns: u64) -> SceneUpdate {
    update(vec![entity("policy", WORLD, time_ns)])
}

/// The greatest magnitude of what the best actions are worth; above 0.
pub(super) fn greatest_magnitude(policy: &PolicyMap) -> f64 {
    let best = policy.cells().filter_map(|(_, worth)| worth.greatest());
    best.map(f64::abs).fold(f64::MIN_POSITIVE, f64::max)
}

/// An arrow at the border of a cell.
fn arrow(maze: &Maze, cell: Cell, direction: Direction, colour: Option<Color>) -> ArrowPrimitive {
    let (unit, at) = (maze.cell_size_m(), maze.centre_m(cell));
    let (east, south) = direction.offset();
    let ahead = UnitComplex::new_normalize(Complex::new(f64::from(east), f64::from(-south)));
    let tail = TAIL * unit;
    ArrowPrimitive {
        pose: Some(Pose {
            position: Some(vector(
                at.x + tail * ahead.re,
                at.y + tail * ahead.im,
                0.07 * unit,
            )),
            orientation: Some(heading(ahead)),
        }),
        shaft_length: rounded(SHAFT * unit),
        shaft_diameter: rounded(0.12 * unit),
        head_length: rounded(HEAD * unit),
        head_diameter: rounded(0.3 * unit),
        color: colour,
    }
}

/// The colour of a rank, from 0 (worst) to 1 (best).
fn shade(rank: f64) -> Option<Color> {
    let [worst, middle, best] = SCALE.map(|rgb| color(rgb, 1.0).unwrap_or_default());
    let (from, to, share) = match rank < 0.5 {
        true => (worst, middle, 2.0 * rank),
        false => (middle, best, 2.0 * rank - 1.0),
    };
    let blend = |from: f64, to: f64| rounded(from + (to - from) * share);
    Some(Color {
        r: blend(from.r, to.r),
        g: blend(from.g, to.g),
        b: blend(from.b, to.b),
        a: 1.0,
    })
}
