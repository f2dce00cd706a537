//! How far odometry drifts from one rest to the next.

use nalgebra::Isometry2;

use super::{Found, Step};
use crate::arena::{PhysicsParams, Speeds};
use crate::record::rolled;

/// The least way in m that tells the scale, or the drift.
const LEAST_M: f64 = 0.1;
/// The most that the squared ways of steps may exceed those of a straight move. Turns to both sides
/// hide the drift.
const MOST_DETOUR: f64 = 3.0;
/// The least number of moves that tell a deviation.
const LEAST_MOVES: usize = 10;

/// Returns the error of the scale of odometry, and the deviation of the scale of a wheel in a move.
/// The poses are those of the filter, which has the lidar.
pub fn values(
    steps: &[Step],
    commands: &[(u64, Speeds)],
    physics: &PhysicsParams,
) -> [Option<Found>; 2] {
    let (mut scales, mut drifts) = (Vec::new(), Vec::new());
    let base_m = physics.wheel_base_m;
    for pair in starts(steps, commands).windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let mut odometry = Isometry2::identity();
        let (mut ways_m, mut squares) = ([0.0; 2], 0.0);
        for step in &steps[from + 1..=to] {
            odometry *= rolled([0.0; 2], step.rolled_m, base_m);
            for (way_m, rolled_m) in ways_m.iter_mut().zip(step.rolled_m) {
                *way_m += rolled_m;
                squares += rolled_m * rolled_m;
            }
        }
        let moved = steps[from].pose.inverse() * steps[to].pose;
        let [by_odometry_m, moved_m] = [odometry, moved].map(|it| it.translation.vector.norm());
        if by_odometry_m > LEAST_M {
            scales.push(by_odometry_m / moved_m - 1.0);
        }
        let way_m = ways_m[0].hypot(ways_m[1]);
        let share = squares / (way_m * way_m);
        if way_m > LEAST_M && share * (to - from) as f64 <= MOST_DETOUR {
            let turn_rad = (odometry.inverse() * moved).rotation.angle();
            drifts.push((turn_rad * base_m / way_m, share));
        }
    }
    let scale = mean(&scales)
        .map(|(mean, deviation)| Found::new(mean, deviation / (scales.len() as f64).sqrt()));
    [scale, drift(&drifts, physics)]
}

/// Returns the numbers of the last steps before moves: the robot is commanded to rest, and then to move.
fn starts(steps: &[Step], commands: &[(u64, Speeds)]) -> Vec<usize> {
    let is_rest = |step: &Step| {
        let next = commands.partition_point(|(time_ns, _)| *time_ns < step.end_ns);
        let command = next.checked_sub(1).map(|number| commands[number].1);
        command.is_none_or(|speeds| speeds == Speeds::REST)
    };
    let rests: Vec<bool> = steps.iter().map(is_rest).collect();
    let is_start = |number: &usize| rests[*number] && !rests[*number + 1];
    (0..rests.len().saturating_sub(1))
        .filter(is_start)
        .collect()
}

/// Returns the deviation of the drifts, without the share that changes from step to step.
fn drift(drifts: &[(f64, f64)], physics: &PhysicsParams) -> Option<Found> {
    let [of_moves, shares] = [0, 1].map(|part| {
        let part = drifts.iter().map(|both| [both.0, both.1][part]);
        part.collect::<Vec<f64>>()
    });
    let (_, deviation) = mean(&of_moves)?;
    let (share, _) = mean(&shares)?;
    let of_steps = physics.noise * physics.wheel_noise;
    let deviation = (deviation * deviation - of_steps * of_steps * share)
        .max(0.0)
        .sqrt();
    let error = deviation / (2.0 * of_moves.len() as f64).sqrt();
    Some(Found::new(deviation, error))
}

/// Returns the mean and the deviation of the numbers of enough moves.
fn mean(numbers: &[f64]) -> Option<(f64, f64)> {
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let squares = numbers.iter().map(|number| (number - mean).powi(2));
    let deviation = (squares.sum::<f64>() / (count - 1.0)).sqrt();
    (numbers.len() >= LEAST_MOVES).then_some((mean, deviation))
}
