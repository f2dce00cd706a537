//! How the ranges of the lidar scatter while the robot rests.

use std::f64::consts::PI;

use nalgebra::{Isometry2, Vector2};
use xcscr_sensing::{Return, cast};

use super::Found;
use super::squares::{Observation, fitted, matrices};
use crate::arena::LidarParams;
use crate::world::Maze;

/// Half of the angle in rad over which the slope of a wall is measured.
const ASIDE_RAD: f64 = 0.02;
/// The largest change of the range over that angle, as a share of the range. At corners and walls that
/// are seen at a sharp angle, an error of the direction would count as an error of the range.
const FLAT: f64 = 0.01;
/// The largest error of a range that is noise, in deviations of the profile, and in m.
const GATE: [f64; 2] = [8.0, 0.02];
/// The share of the lidar's range beyond which an echo may be missing for the distance alone.
const SURE: f64 = 0.9;

/// A beam with more influence than this on the explained errors says little about noise.
const MOST_INFLUENCE: f64 = 0.5;

/// The beams at rest.
#[derive(Default)]
pub struct Ranges {
    /// The expected range, the absolute error, and the number of the rest.
    errors: Vec<(f64, f64, usize)>,
    /// The number of beams that a flat wall should have returned, and of those that were lost.
    expected: usize,
    lost: usize,
}

/// A beam that hits a flat wall: its direction, the range by the map, the change of the range with the
/// angle in m/rad, and the error of the measured range.
struct Hit {
    direction: Vector2<f64>,
    range_m: f64,
    slope: f64,
    error_m: f64,
}

impl Ranges {
    /// Takes in the beams of a rest at a pose of the grid frame. An error of the pose, and of the scale
    /// and the offset of the lidar, is no noise.
    pub fn add(
        &mut self,
        rest: usize,
        maze: &Maze,
        pose: &Isometry2<f64>,
        beams: &[Return],
        lidar: &LidarParams,
    ) {
        let mut hits = Vec::new();
        for beam in beams {
            let direction = (pose.rotation * beam.bearing) * Vector2::x();
            let Some((range_m, slope)) = flat_wall(maze, pose, direction, lidar) else {
                continue;
            };
            self.expected += 1;
            let Some(measured_m) = beam.range_m else {
                self.lost += 1;
                continue;
            };
            let error_m = measured_m - range_m;
            if error_m.abs() < GATE[0] * deviation_m(lidar, range_m) + GATE[1] {
                hits.push(Hit {
                    direction,
                    range_m,
                    slope,
                    error_m,
                });
            }
        }
        self.errors.extend(
            noise(&hits)
                .into_iter()
                .map(|(range_m, error_m)| (range_m, error_m, rest)),
        );
    }

    /// Returns the constant part of the deviation of a range in m, the part that grows with the range,
    /// and the share of lost beams.
    pub fn values(&self, lidar: &LidarParams) -> [Option<Found>; 3] {
        let observation = |&(range_m, error_m, group): &(f64, f64, usize)| {
            let deviation_m = deviation_m(lidar, range_m);
            Observation {
                factors: vec![1.0 / deviation_m, range_m / deviation_m],
                // The mean absolute error of a normal distribution is less than its deviation.
                value: error_m * (PI / 2.0).sqrt() / deviation_m,
                group,
            }
        };
        let observations: Vec<_> = self.errors.iter().map(observation).collect();
        let part = |number: usize| {
            let [value, error] = fitted(&observations)?[number];
            Some(Found::new(value, error))
        };
        let lost = (self.expected > 0).then(|| {
            let count = self.expected as f64;
            let share = self.lost as f64 / count;
            // With one more lost beam, the interval of no lost beam has a width.
            let more = (self.lost as f64 + 1.0) / count;
            Found::new(share, (more / count).sqrt())
        });
        [part(0), part(1), lost]
    }
}

/// Returns the deviation of a range by the profile, which is never 0.
fn deviation_m(lidar: &LidarParams, range_m: f64) -> f64 {
    (lidar.noise_m + lidar.noise_share * range_m).max(1e-3)
}

/// Returns the range of a flat wall in a direction, and its change with the angle; `None` if there is none
/// that the lidar must see.
fn flat_wall(
    maze: &Maze,
    pose: &Isometry2<f64>,
    direction: Vector2<f64>,
    lidar: &LidarParams,
) -> Option<(f64, f64)> {
    let origin = pose.translation.vector;
    let range = |aside_rad: f64| {
        let turn = nalgebra::UnitComplex::new(aside_rad);
        cast(maze, origin, turn * direction, SURE * lidar.range_m)
    };
    let [right_m, range_m, left_m] = [range(-ASIDE_RAD)?, range(0.0)?, range(ASIDE_RAD)?];
    let is_flat = [right_m, left_m]
        .iter()
        .all(|aside_m| (aside_m - range_m).abs() < FLAT * range_m);
    let is_near = range_m < lidar.nearest_m + GATE[1];
    (is_flat && !is_near).then_some((range_m, (left_m - right_m) / (2.0 * ASIDE_RAD)))
}

/// Returns the expected range and the absolute error of each beam, without what an error of the pose,
/// the scale and the offset explains.
fn noise(hits: &[Hit]) -> Vec<(f64, f64)> {
    let observation = |hit: &Hit| {
        let left = Vector2::new(-hit.direction.y, hit.direction.x);
        let along = hit.slope / hit.range_m * left - hit.direction;
        Observation {
            factors: vec![along.x, along.y, hit.slope, hit.range_m, 1.0],
            value: hit.error_m,
            group: 0,
        }
    };
    let observations: Vec<_> = hits.iter().map(observation).collect();
    let Some((design, errors_m)) = matrices(&observations) else {
        return Vec::new();
    };
    let Some(inverse) = (design.transpose() * &design).try_inverse() else {
        return Vec::new();
    };
    let explained = &design * (&inverse * design.transpose() * &errors_m);
    let left_m = errors_m - explained;
    // A beam with much influence on the explained part loses much of its noise to it.
    let influence = |row: usize| (design.row(row) * &inverse).dot(&design.row(row));
    let noise_m = |row: usize| left_m[row].abs() / (1.0 - influence(row)).sqrt();
    let rows = (0..hits.len()).filter(|row| influence(*row) < MOST_INFLUENCE);
    rows.map(|row| (hits[row].range_m, noise_m(row))).collect()
}
