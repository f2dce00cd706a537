//! How the motors follow commands.

use nalgebra::{DMatrix, DVector};

use super::squares::{Observation, fitted, matrices};
use super::{Found, Step};
use crate::arena::{PhysicsParams, Speeds, rolled_by};
use xcscr_sensing::STEP_NS;

const SECOND_NS: f64 = 1e9;
/// The changes by which derivatives are computed: a share of a setting, seconds of lag, or a factor.
const CHANGE: f64 = 0.02;
/// The largest number of iterations. Ten are usual.
const ITERATIONS: usize = 60;
/// A value that changes no wheel by this way in m is not seen.
const LEAST_M: f64 = 1e-6;

/// The parameters of the motors: the largest speed and turn rate, the acceleration, the lag in
/// seconds, and how odometry mixes the ways of the wheels: left to left, right to left, and the same to
/// right.
type Parameters = [f64; 8];

/// Returns the largest speed, the largest turn rate, the acceleration and the lag in seconds. The
/// commands are sorted by their time in nanoseconds of the robot's clock.
pub fn values(
    steps: &[Step],
    commands: &[(u64, Speeds)],
    physics: &PhysicsParams,
) -> [Option<Found>; 4] {
    let motors = Motors {
        steps,
        commands,
        physics,
    };
    let mut found = [None; 4];
    let at = motors.fit();
    let (seen, observations) = motors.linearised(&at);
    let Some(offsets) = fitted(&observations) else {
        return found;
    };
    for (&number, [_, error]) in seen.iter().zip(offsets) {
        if let Some(found) = found.get_mut(number) {
            *found = Some(Found::new(at[number], error));
        }
    }
    found
}

struct Motors<'a> {
    steps: &'a [Step],
    commands: &'a [(u64, Speeds)],
    physics: &'a PhysicsParams,
}

impl Motors<'_> {
    /// Returns the parameters with the least squared error (Levenberg 1944, Marquardt 1963).
    fn fit(&self) -> Parameters {
        let physics = self.physics;
        let mut at = [
            physics.max_speed_mps,
            physics.max_turn_radps,
            physics.wheel_acceleration_mps2,
            0.0,
            1.0,
            0.0,
            0.0,
            1.0,
        ];
        // No faster robot can be seen.
        let fastest = |part: fn(&Speeds) -> f64| {
            let all = self.commands.iter().map(|(_, speeds)| part(speeds).abs());
            all.fold(0.0, f64::max)
        };
        let most = [
            at[0].max(fastest(|speeds| speeds.forward_mps)),
            at[1].max(fastest(|speeds| speeds.turn_radps)),
        ];
        let mut error = self.error(&at);
        let mut damping = 1e-3;
        for _ in 0..ITERATIONS {
            let (seen, observations) = self.linearised(&at);
            let Some(change) = damped(&observations, damping) else {
                break;
            };
            let mut next = at;
            for (&number, change) in seen.iter().zip(change.iter()) {
                next[number] += change;
            }
            (next[0], next[1]) = (next[0].min(most[0]), next[1].min(most[1]));
            let next_error = self.error(&next);
            if next_error < error {
                let is_done = error - next_error < 1e-9 * error;
                (at, error, damping) = (next, next_error, damping / 10.0);
                if is_done {
                    break;
                }
            } else {
                damping *= 4.0;
            }
        }
        at
    }

    /// Returns the numbers of the parameters that the ways of the wheels depend on, and for each wheel
    /// and step the derivatives by them and the remaining error.
    fn linearised(&self, at: &Parameters) -> (Vec<usize>, Vec<Observation>) {
        let rolled_m = self.rolled_m(at);
        let mut columns = Vec::new();
        for number in 0..at.len() {
            let mut lower = *at;
            let change = match number {
                0..3 => CHANGE * at[number],
                _ => CHANGE,
            };
            lower[number] -= change;
            let differences = rolled_m.iter().zip(self.rolled_m(&lower));
            let column: Vec<f64> = differences.map(|(here, lower)| here - lower).collect();
            if column.iter().any(|way_m| way_m.abs() > LEAST_M) {
                let scaled = column.iter().map(|way_m| way_m / change).collect();
                columns.push((number, scaled));
            }
        }
        let observation = |(row, predicted): (usize, &f64)| Observation {
            factors: columns
                .iter()
                .map(|(_, column): &(_, Vec<f64>)| column[row])
                .collect(),
            value: self.steps[row / 2].rolled_m[row % 2] - predicted,
            group: self.steps[row / 2].group,
        };
        let observations = rolled_m.iter().enumerate().map(observation).collect();
        (
            columns.iter().map(|(number, _)| *number).collect(),
            observations,
        )
    }

    fn error(&self, at: &Parameters) -> f64 {
        let [max_speed_mps, max_turn_radps, acceleration, lag_s, ..] = *at;
        let is_possible = max_speed_mps > 0.0 && max_turn_radps > 0.0 && acceleration > 0.0;
        if !is_possible || lag_s.abs() > 1.0 {
            return f64::INFINITY;
        }
        let measured = self.steps.iter().flat_map(|step| step.rolled_m);
        let off = measured
            .zip(self.rolled_m(at))
            .map(|(one, other)| one - other);
        off.map(|off| off * off).sum()
    }

    /// Returns the ways of the left and the right wheel in each step that the parameters predict.
    fn rolled_m(&self, at: &Parameters) -> Vec<f64> {
        let [
            max_speed_mps,
            max_turn_radps,
            wheel_acceleration_mps2,
            lag_s,
            ..,
        ] = *at;
        let [.., left_left, right_left, left_right, right_right] = *at;
        let physics = PhysicsParams {
            max_speed_mps,
            max_turn_radps,
            wheel_acceleration_mps2,
            ..self.physics.clone()
        };
        let commands = self
            .steps
            .iter()
            .map(|step| self.command(step.end_ns, lag_s));
        let rolled = rolled_by(commands, &physics);
        rolled
            .into_iter()
            .flat_map(|[left, right]| {
                [
                    left_left * left + right_left * right,
                    left_right * left + right_right * right,
                ]
            })
            .collect()
    }

    /// Returns the mean command that a robot with this lag follows during a step.
    fn command(&self, end_ns: u64, lag_s: f64) -> Speeds {
        let end_s = end_ns as f64 / SECOND_NS - lag_s;
        let step_s = STEP_NS as f64 / SECOND_NS;
        let begin_s = end_s - step_s;
        let time_s = |at: usize| {
            self.commands
                .get(at)
                .map_or(f64::INFINITY, |c| c.0 as f64 / SECOND_NS)
        };
        let begin_ns = (begin_s * SECOND_NS).max(0.0) as u64;
        let first = self
            .commands
            .partition_point(|(time_ns, _)| *time_ns <= begin_ns);
        let mut mean = Speeds::REST;
        for number in first.saturating_sub(1).. {
            let from_s = time_s(number).max(begin_s);
            if from_s >= end_s {
                break;
            }
            let share = (time_s(number + 1).min(end_s) - from_s) / step_s;
            let speeds = self.commands[number].1;
            mean.forward_mps += share * speeds.forward_mps;
            mean.turn_radps += share * speeds.turn_radps;
        }
        mean
    }
}

/// Returns the change of the parameters that reduces the remaining errors.
fn damped(observations: &[Observation], damping: f64) -> Option<DVector<f64>> {
    let (design, remaining) = matrices(observations)?;
    let normal = design.transpose() * &design;
    let more = DMatrix::from_diagonal(&normal.diagonal()) * damping;
    Some((normal + more).try_inverse()? * design.transpose() * remaining)
}
