//! Checks that the robot fits between the walls.

use super::{PhysicsError, PhysicsParams};
use crate::world::{Cell, Direction, Maze};

/// Accepts a robot that fits into a world.
///
/// In a maze the robot drives along the middles of cells. In a cell next to a wall it has half a
/// cell to that wall. It needs its radius plus the distance at which a move counts as finished
/// ([`PhysicsParams::arrival_m`]). In a world from a map it needs as much on every side along the
/// moves from the start to a goal.
///
/// # Errors
/// [`PhysicsError::TooNarrow`] with the first cell that is next to a wall, or
/// [`PhysicsError::NoWay`] with the narrowest place.
pub fn check_fit(maze: &Maze, params: &PhysicsParams) -> Result<(), PhysicsError> {
    match maze.is_from_map() {
        true => fitted(maze, params).map(|_| ()),
        false => check_cells(maze, params),
    }
}

/// Returns the world with the cells and moves that the robot can use ([`Maze::for_robot`]).
///
/// # Errors
/// Those of [`check_fit`].
pub(super) fn fitted(maze: &Maze, params: &PhysicsParams) -> Result<Maze, PhysicsError> {
    let needed_m = params.needed_m();
    if !maze.is_from_map() {
        return check_cells(maze, params).map(|()| maze.clone());
    }
    maze.for_robot(needed_m).ok_or_else(|| {
        let ends = maze.starts().next().zip(maze.goals().first().copied());
        let narrowest = ends.and_then(|(start, goal)| {
            let ends = [start, goal].map(|cell| maze.centre_in_grid(cell));
            maze.solid().narrowest_between(ends)
        });
        PhysicsError::NoWay {
            world: maze.name().to_owned(),
            needed_m,
            narrowest: narrowest.map(|it| (maze.point_in_map(it.at).into(), it.width_m)),
        }
    })
}

fn check_cells(maze: &Maze, params: &PhysicsParams) -> Result<(), PhysicsError> {
    let needed_m = params.needed_m();
    let distance_m = maze.cell_size_m() / 2.0;
    if distance_m >= needed_m {
        return Ok(());
    }
    let is_narrow = |&cell: &Cell| {
        let sides = Direction::CLOCKWISE.into_iter().step_by(2);
        let mut sides = sides.filter_map(|side| maze.neighbour(cell, side));
        sides.any(|side| maze.is_wall(side))
    };
    let Some(cell) = maze.starts().chain(maze.free_cells()).find(is_narrow) else {
        return Ok(());
    };
    Err(PhysicsError::TooNarrow {
        world: maze.name().to_owned(),
        cell,
        at_m: maze.centre_m(cell).into(),
        distance_m,
        radius_m: params.radius_m,
        tolerance_m: params.arrival_m,
        least_cell_m: params.least_cell_m(),
        largest_radius_m: Some(rounded_down_mm(distance_m - params.arrival_m))
            .filter(|&radius_m| is_allowed(radius_m, params)),
    })
}

/// Rounds down to whole millimetres.
fn rounded_down_mm(length_m: f64) -> f64 {
    (length_m * 1000.0 + 1e-6).floor() / 1000.0
}

/// Returns true if the settings allow this radius.
fn is_allowed(radius_m: f64, params: &PhysicsParams) -> bool {
    let params = PhysicsParams {
        radius_m,
        ..params.clone()
    };
    params.check().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(cell_size_m: f64, radius_m: f64) -> Option<String> {
        let rows = ["######", "#....#", "#.S.G#", "######"];
        let text =
            format!(r#"{{ "name": "hall", "cell_size_m": {cell_size_m}, "rows": {rows:?} }}"#);
        let maze = Maze::from_json(text.as_bytes(), "hall.json").unwrap();
        let params = PhysicsParams {
            radius_m,
            ..PhysicsParams::default()
        };
        check_fit(&maze, &params)
            .err()
            .map(|error| error.to_string())
    }

    #[test]
    fn a_robot_that_does_not_fit_is_refused_with_the_cell_and_the_sizes_that_fit() {
        let message = refusal(0.25, 0.3).unwrap();
        for part in [
            "`hall`",
            "column 2, row 2",
            "at 0.62, 0.38 m",
            "0.125 m",
            "0.334 m",
            "0.300 m",
            "0.668 m",
            "0.091 m",
        ] {
            assert!(message.contains(part), "{part}: {message}");
        }
    }

    #[test]
    fn a_radius_below_the_smallest_allowed_one_is_not_named() {
        // The default robot stops up to 34 mm from the middle, and no robot has a radius below 20 mm.
        let [named, unnamed] = [0.11, 0.1].map(|size_m| refusal(size_m, 0.3).unwrap());
        assert!(named.contains("a radius of at most 0.021 m"), "{named}");
        assert!(!unnamed.contains("radius of at most"), "{unnamed}");
        assert!(
            unnamed.ends_with("use cells of at least 0.668 m (`cell_size_m`)"),
            "{unnamed}"
        );
    }

    #[test]
    fn the_sizes_in_the_refusal_fit() {
        assert_eq!(refusal(0.668, 0.3), None);
        assert_eq!(refusal(0.25, 0.091), None);
        assert!(refusal(0.667, 0.3).is_some(), "control: a millimetre less");
        assert!(refusal(0.25, 0.092).is_some(), "control: a millimetre more");
    }
}
