//! Errors when building a physics arena.

use crate::world::Cell;
use xcs::bounds::OutOfRange;

/// The physics arena cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PhysicsError {
    /// A setting is out of range.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// The edges of the world join; a robot cannot drive through a border.
    #[error(
        "world `{world}` joins its edges (`\"wrap\": true`), which cannot be simulated; use `--arena grid`, or close its border with walls"
    )]
    JoinedEdges {
        /// The world's name.
        world: String,
    },
    /// The world has diagonal moves, which cut the corners of walls.
    #[error(
        "world `{world}` has eight moves, and a diagonal one would cut the corners of walls; use `--arena grid`, or set `\"moves\": 4`"
    )]
    EightMoves {
        /// The world's name.
        world: String,
    },
    /// The robot is too large for the cells.
    #[error(
        "the robot does not fit into world `{world}`: in column {}, row {} (at {:.2}, {:.2} m) the wall is {distance_m:.3} m from the middle of the cell, but the robot needs {:.3} m (its radius of {radius_m:.3} m, and {tolerance_m:.3} m because it may stop that far from the middle); use cells of at least {least_cell_m:.3} m (`cell_size_m`){}",
        cell.col,
        cell.row,
        at_m[0],
        at_m[1],
        radius_m + tolerance_m,
        largest_radius_m.map_or_else(String::new, |radius_m| format!(
            ", or a robot with a radius of at most {radius_m:.3} m (`--robot`, `physics.radius_m`)"
        ))
    )]
    TooNarrow {
        /// The world's name.
        world: String,
        /// A cell that is too narrow.
        cell: Cell,
        /// The middle of this cell in the map frame, in metres.
        at_m: [f64; 2],
        /// The distance from the middle of this cell to the wall, in metres.
        distance_m: f64,
        /// The robot's radius in metres.
        radius_m: f64,
        /// `physics.arrival_m`: how far from the middle a move may end, in metres.
        tolerance_m: f64,
        /// The smallest size of a cell into which this robot fits, in metres.
        least_cell_m: f64,
        /// The largest radius that fits into these cells, in metres. `None` if it is below the smallest
        /// allowed value of `physics.radius_m`.
        largest_radius_m: Option<f64>,
    },
    /// No way of the map from the start to a goal is wide enough for the robot, along the cells.
    #[error(
        "the robot does not fit into world `{world}`: it needs {needed_m:.3} m on each side of its middle, and no moves from the start to a goal leave that{}",
        place(narrowest.as_ref())
    )]
    NoWay {
        /// The world's name.
        world: String,
        /// The radius of the disc that must stay clear: the robot's radius and `physics.arrival_m`,
        /// in metres.
        needed_m: f64,
        /// The narrowest place of the widest way: the place in the map frame, and its width, in
        /// metres. `None` if there is no way.
        narrowest: Option<([f64; 2], f64)>,
    },
    /// The world is too wide: the engine's single precision could not resolve a millimetre.
    #[error(
        "world `{world}` is {extent_m:.0} m wide, more than the {limit_m:.0} m that can be simulated; use smaller cells (`cell_size_m`), or `--arena grid`"
    )]
    TooWide {
        /// The world's name.
        world: String,
        /// Its longer side in metres.
        extent_m: f64,
        /// The largest side allowed, in metres.
        limit_m: f64,
    },
    /// The maze has too many walls to simulate.
    #[error(
        "world `{world}` needs {count} wall blocks, more than the {limit} that can be simulated; use `--arena grid`"
    )]
    TooManyWalls {
        /// The world's name.
        world: String,
        /// The number of rectangles that cover the walls.
        count: usize,
        /// The largest number allowed.
        limit: usize,
    },
}

/// Describes the narrowest place of the widest way.
fn place(narrowest: Option<&([f64; 2], f64)>) -> String {
    narrowest.map_or_else(String::new, |([x, y], width_m)| {
        format!(
            "; the widest way is {width_m:.2} m wide at {x:.2}, {y:.2} m; convert the map with smaller cells, or take a smaller robot"
        )
    })
}
