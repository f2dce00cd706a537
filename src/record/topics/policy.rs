//! `/scene/policy`: the best action of each cell, coloured by its worth (the paper's figure 5).

use foxglove::messages::{ArrowPrimitive, Color, Pose, SceneUpdate};
use nalgebra::{Complex, UnitComplex};

use super::rounded;
use super::scene::{WORLD, color, entity, heading, update, vector};
use crate::episode::PolicyMap;
use crate::world::{Cell, Direction, Maze};

/// The colours of the least worth, of none and of the greatest: red, grey, blue.
const SCALE: [u32; 3] = [0xd81f2a, 0x8d94a3, 0x1554d1];

/// An arrow in each cell that knows a best action; the first of the best on ties.
pub(in crate::record) fn scene(policy: &PolicyMap, maze: &Maze, time_ns: u64) -> SceneUpdate {
    let most = greatest_magnitude(policy);
    let mut arrows = entity("policy", WORLD, time_ns);
    arrows.arrows = policy
        .cells()
        .filter_map(|(cell, worth)| {
            let direction = maze.direction(worth.best_actions().next()?)?;
            Some(arrow(maze, *cell, direction, worth.greatest()? / most))
        })
        .collect();
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

/// An arrow whose middle is the cell's; `share` runs from -1 (worst) to 1 (best).
fn arrow(maze: &Maze, cell: Cell, direction: Direction, share: f64) -> ArrowPrimitive {
    let (unit, at) = (maze.cell_size_m(), maze.centre_m(cell));
    let (east, south) = direction.offset();
    let ahead = UnitComplex::new_normalize(Complex::new(f64::from(east), f64::from(-south)));
    let tail = 0.28 * unit;
    ArrowPrimitive {
        pose: Some(Pose {
            position: Some(vector(
                at.x - tail * ahead.re,
                at.y - tail * ahead.im,
                0.07 * unit,
            )),
            orientation: Some(heading(ahead)),
        }),
        shaft_length: rounded(0.32 * unit),
        shaft_diameter: rounded(0.09 * unit),
        head_length: rounded(0.24 * unit),
        head_diameter: rounded(0.24 * unit),
        color: shade(share),
    }
}

/// The colour of a worth, from -1 to 1.
fn shade(share: f64) -> Option<Color> {
    let [worst, none, best] = SCALE.map(|rgb| color(rgb, 1.0).unwrap_or_default());
    let end = if share < 0.0 { worst } else { best };
    let blend = |from: f64, to: f64| rounded(from + (to - from) * share.abs().min(1.0));
    Some(Color {
        r: blend(none.r, end.r),
        g: blend(none.g, end.g),
        b: blend(none.b, end.b),
        a: 1.0,
    })
}
