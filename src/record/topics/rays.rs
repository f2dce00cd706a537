//! The lidar rays in `/scene/percept`: the last turn, from the robot to the hit points.

use std::f64::consts::TAU;

use foxglove::messages::{LinePrimitive, Point3, SceneEntity};
use nalgebra::{Point2, Vector2};

use super::scan::angle;
use super::scene::{WORLD, color, entity, lines, place, point, size_m};
use crate::arena::{Beam, View};

/// The colour of a beam, and of its end in `/scan` in the layouts.
pub(in crate::record) const BEAM: u32 = 0xc23ee8;
const OPACITY: f64 = 0.75;
/// The height of the rays, in cells.
const HEIGHT: f64 = 0.2;
/// The grid that the ends of rays are aligned to, in cells.
const GRID: f64 = 1.0 / 64.0;

/// Creates the rays of the last turn before the decision; `None` if the robot is given its pose.
pub(in crate::record) fn rays(view: &View<'_>) -> Option<SceneEntity> {
    let (maze, beams) = (view.maze, view.sensed?.beams);
    let (at, unit) = (maze.centre_in_grid(view.cell), maze.cell_size_m());
    // Coordinates relative to the cell are alike in all cells and compress well.
    let on_grid = |there: Point2<f64>| {
        let steps = ((there - at) / (GRID * unit)).map(f64::round);
        point(Point2::from(steps * (GRID * unit)), 0.0)
    };
    let (mut points, mut indices): (Vec<Point3>, Vec<u32>) = (Vec::new(), Vec::new());
    let mut origin = None;
    for (from, to) in last_turn(beams).iter().filter_map(|beam| ray(view, beam)) {
        let from = on_grid(from);
        if origin.as_ref().is_none_or(|(_, before)| *before != from) {
            origin = Some((points.len() as u32, from));
            points.push(from);
        }
        let begin = origin.as_ref().map_or(0, |(number, _)| *number);
        indices.extend([begin, points.len() as u32]);
        points.push(on_grid(to));
    }
    let mut rays = entity("beams", WORLD, view.now().time_ns);
    let pose = place(at.x, at.y, HEIGHT * unit);
    rays.lines = vec![LinePrimitive {
        scale_invariant: true,
        indices,
        ..lines(pose, 1.5, points, color(BEAM, OPACITY))
    }];
    Some(rays)
}

/// Returns the beams of the last full turn, or all if there are fewer.
fn last_turn(beams: &[Beam]) -> &[Beam] {
    let [.., before, last] = beams else {
        return beams;
    };
    let apart_rad = angle(before.bearing.inverse() * last.bearing);
    let in_a_turn = (TAU / apart_rad).round() as usize;
    &beams[beams.len().saturating_sub(in_a_turn.max(1))..]
}

/// Returns the origin and the hit point of a beam, in the grid frame; `None` without a measured
/// range.
fn ray(view: &View<'_>, beam: &Beam) -> Option<(Point2<f64>, Point2<f64>)> {
    let after = view
        .trace
        .partition_point(|sample| sample.time_ns <= beam.time_ns);
    let pose = view.trace.get(after.saturating_sub(1))?.robot_in_map;
    let from = Point2::from(pose.translation.vector);
    let ahead = pose.rotation
        * beam.bearing
        * Vector2::new(beam.range_m.filter(|range_m| range_m.is_finite())?, 0.0);
    let [from, to] = [from, from + ahead].map(|point| view.maze.point_in_grid(point));
    Some((from, within(from, to, size_m(view.maze))))
}

/// Clips a ray to the maze, whose side lengths are in metres: a range can be far too long.
fn within(from: Point2<f64>, to: Point2<f64>, size: [f64; 2]) -> Point2<f64> {
    let ahead = to - from;
    let share = |axis: usize| {
        let wall = if ahead[axis] > 0.0 { size[axis] } else { 0.0 };
        match ahead[axis] == 0.0 {
            true => 1.0,
            false => (wall - from[axis]) / ahead[axis],
        }
    };
    from + ahead * share(0).min(share(1)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Complex, UnitComplex};

    #[test]
    fn a_ray_ends_at_the_edge_of_the_maze_at_the_latest() {
        let from = Point2::new(1.0, 2.0);
        let end = |x, y| within(from, Point2::new(x, y), [4.0, 3.0]);
        assert_eq!(end(3.0, 2.5), Point2::new(3.0, 2.5));
        assert_eq!(end(7.0, 2.0), Point2::new(4.0, 2.0));
        assert_eq!(end(1.0, 12.0), Point2::new(1.0, 3.0));
        assert_eq!(end(-1.0, 0.0), Point2::new(0.0, 1.0));
    }

    #[test]
    fn a_turn_has_each_direction_once() {
        let beam = |number: u32| {
            let (sine, cosine) = libm::sincos(f64::from(number) * TAU / 32.0);
            Beam {
                time_ns: u64::from(number),
                bearing: UnitComplex::new_unchecked(Complex::new(cosine, sine)),
                range_m: Some(1.0),
            }
        };
        let beams: Vec<Beam> = (0..75).map(beam).collect();
        let numbers: Vec<u64> = last_turn(&beams).iter().map(|beam| beam.time_ns).collect();
        assert_eq!(numbers, (43..75).collect::<Vec<_>>());
        // Control: fewer than a turn.
        assert_eq!(last_turn(&beams[..5]).len(), 5);
        assert_eq!(last_turn(&beams[..1]).len(), 1);
    }
}
