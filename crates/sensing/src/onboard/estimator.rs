//! Where the robot believes to be: an extended Kalman filter over wheels, gyro and lidar.
//!
//! It needs no map. All it knows of the world is that walls lie on the lines of the grid, so that
//! a beam ends on one: the distance to the nearest line is what it corrects by. On such a grid a
//! filter that is too sure of itself locks in one cell off, and no beam can tell. So it assumes
//! more noise than there is, and where several beams disagree with it, it trusts itself less
//! ([`EstimatorParams::batch_check`]). Lengths in cells, angles in radians.

use nalgebra::{Isometry2, Matrix3, SMatrix, SVector, UnitComplex, Vector2};
use serde::{Deserialize, Serialize};

use super::angle::{cayley, rotation, square};
use super::assumed::Assumed;
use super::slip::Slip;
use crate::{EstimatorParams, Readings, Return, Robot, STEP_S};

/// Places in the state: position, heading, gyro bias, scale of the wheels, scale of the ranges, and
/// by how much the wheels roll otherwise in this action.
const X: usize = 0;
const Y: usize = 1;
const HEADING: usize = 2;
const BIAS: usize = 3;
const WHEELS: usize = 4;
const RANGES: usize = 5;
const ROLL: usize = 6;
const STATES: usize = 7;

/// A beam along an axis less than this (a cosine) says nothing about lines across that axis.
const SHALLOW: f64 = 0.25;
/// What a bump may add to the position, as a deviation.
const BUMP_SLIDE: f64 = 0.02;
/// The deviation of the position that is added where beams disagree with it.
const DOUBT: f64 = 0.08;
/// Wheels that speed up or brake may slip: deviation of the way as a share of by how much it differs
/// from that of the step before.
const LAG: f64 = 0.6;
/// So many disagreeing beams more than agreeing ones are too many ...
const UNBEARABLE: f64 = 2.5;
/// ... of which this share is kept from step to step.
const KEPT_STRAIN: f64 = 0.7;

/// The filter's state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Belief {
    pose: Isometry2<f64>,
    /// Gyro bias in rad/s.
    bias: f64,
    /// By what share the wheels roll farther than they count.
    wheels: f64,
    /// By what share ranges are longer than they are measured.
    ranges: f64,
    /// By what further share the wheels roll farther during this action.
    roll: f64,
    last: LastStep,
    /// Whether the wheels slip.
    slip: Slip,
    /// How many more beams have lately disagreed than agreed with the position, along x and y.
    strain: [f64; 2],
    /// Over position, heading, bias, wheels, ranges and roll.
    covariance: SMatrix<f64, STATES, STATES>,
}

/// How the robot moved in the last step, as far as it knows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct LastStep {
    way: Vector2<f64>,
    turned_rad: f64,
    forward: f64,
    /// What the wheels counted.
    rolled: f64,
}

/// The filter.
#[derive(Debug, Clone)]
pub(crate) struct Estimator {
    params: EstimatorParams,
    assumed: Assumed,
    belief: Belief,
}

/// A beam from where the robot believes that it was sent: its origin, its direction, and its
/// range without the scale that the robot believes in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    /// In the world frame.
    pub origin: Vector2<f64>,
    /// A unit vector.
    pub direction: Vector2<f64>,
    /// `None` when nothing came back.
    pub range: Option<f64>,
}

/// How a beam fits to the nearest line across one axis.
#[derive(Debug, Clone, Copy)]
struct Fit {
    axis: usize,
    /// From where the beam ends to the line.
    residual: f64,
    /// The derivatives of the end by heading and by the scale of ranges; by the axis it is 1.
    by_heading: f64,
    by_ranges: f64,
    /// The variance of the residual.
    variance: f64,
}

impl Fit {
    /// The squared residual in units of its variance.
    fn distance(&self) -> f64 {
        self.residual * self.residual / self.variance
    }
}

impl Estimator {
    /// A filter that knows nothing of its sensors yet, for a robot at the origin.
    pub fn new(robot: &Robot) -> Self {
        let assumed = Assumed::new(robot);
        let Assumed {
            bias,
            wheels,
            ranges,
            ..
        } = assumed;
        let variances = [0.0, 0.0, 0.0, bias, wheels, ranges, 0.0].map(square);
        Self {
            params: robot.estimator.clone(),
            belief: Belief {
                pose: Isometry2::identity(),
                bias: 0.0,
                wheels: 0.0,
                ranges: 0.0,
                roll: 0.0,
                last: LastStep::default(),
                slip: Slip::default(),
                strain: [0.0; 2],
                covariance: SMatrix::from_diagonal(&SVector::from(variances)),
            },
            assumed,
        }
    }

    /// The robot is put down at rest, within a centimetre of `pose`. What it has learned about its
    /// sensors stays.
    pub fn put_down(&mut self, pose: Isometry2<f64>) {
        let Belief { covariance, .. } = &mut self.belief;
        for at in [X, Y, HEADING] {
            covariance.row_mut(at).fill(0.0);
            covariance.column_mut(at).fill(0.0);
            covariance[(at, at)] = 1e-4;
        }
        self.belief.pose = pose;
        self.belief.slip = Slip::default();
        self.belief.strain = [0.0; 2];
        self.belief.last = LastStep::default();
    }

    /// The pose that it believes in.
    pub fn pose(&self) -> Isometry2<f64> {
        self.belief.pose
    }

    /// The covariance of x, y and heading.
    pub fn covariance(&self) -> Matrix3<f64> {
        self.belief.covariance.fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// Speed along the heading per second, and turn rate in rad/s.
    pub fn speeds(&self) -> (f64, f64) {
        (
            self.belief.last.forward / STEP_S,
            self.belief.last.turned_rad / STEP_S,
        )
    }

    /// Has it noticed lately that the wheels slip?
    pub fn slips(&self) -> bool {
        self.belief.slip.is_noticed()
    }

    /// The whole state.
    pub fn belief(&self) -> &Belief {
        &self.belief
    }

    /// Goes back to a state between two actions.
    pub fn set_belief(&mut self, belief: Belief) {
        self.belief = belief;
    }

    /// A new action begins, in which the wheels roll otherwise than before.
    pub fn begin_action(&mut self) {
        self.belief.roll = 0.0;
        let covariance = &mut self.belief.covariance;
        covariance.row_mut(ROLL).fill(0.0);
        covariance.column_mut(ROLL).fill(0.0);
        // Of two wheels the mean counts.
        covariance[(ROLL, ROLL)] = square(self.assumed.roll_bias) / 2.0;
    }

    /// Takes in what the sensors told about a step.
    pub fn step(&mut self, readings: &Readings<'_>) {
        self.predict(readings);
        self.belief.strain = self.belief.strain.map(|strain| KEPT_STRAIN * strain);
        for beam in readings.beams {
            self.take_in(&self.ray(beam));
        }
    }

    /// Moves by what wheels and gyro tell.
    fn predict(&mut self, readings: &Readings<'_>) {
        let Assumed {
            roll_share,
            wheel_share,
            turn_share,
            turn_rad,
            wheel_base,
            ..
        } = self.assumed;
        let [left, right] = readings.rolled;
        let by_wheels = (right - left) / wheel_base;
        let bias_rad = self.belief.bias * STEP_S;
        let turned_rad = readings
            .turned_rad
            .map_or(by_wheels, |told| told - bias_rad);
        let mut rolled = (left + right) / 2.0;
        let bumped = self.params.bump_inflation && readings.bumped.contains(&true);
        // Wheels slip where a wall holds the robot: it moved by something between nothing and all.
        if bumped {
            rolled /= 2.0;
        }
        let forward = (1.0 + self.belief.wheels + self.belief.roll) * rolled;
        let half = rotation(turned_rad / 2.0);
        let middle = self.belief.pose.rotation * half;
        let way = middle * Vector2::new(forward, 0.0);
        self.belief.pose.translation.vector += way;
        self.belief.pose.rotation = UnitComplex::new_normalize((middle * half).into_inner());
        let changed = rolled - self.belief.last.rolled;
        self.belief.last = LastStep {
            way,
            turned_rad,
            forward,
            rolled,
        };

        // A wheel that slips turns the robot less than it counts: then the way is wrong by as much.
        let slipped = (by_wheels - turned_rad) * wheel_base / 2.0;
        let deviation = wheel_share * left.abs().max(right.abs());
        let touches = readings.bumped.contains(&true);
        self.belief
            .slip
            .step(slipped, deviation, touches, &self.params);
        let along =
            square(roll_share * rolled) + square(0.25 * slipped) + square(LAG * changed) + 1e-8;
        let slide = if bumped {
            square(rolled) + square(BUMP_SLIDE)
        } else {
            0.0
        };
        let direction = middle * Vector2::x();
        // The Jacobian of the motion without its diagonal of ones, times a column or a row.
        let drift = if readings.turned_rad.is_some() {
            -STEP_S
        } else {
            0.0
        };
        let moves = |heading: f64, scale: f64, bias: f64| {
            [
                scale * rolled * direction.x - heading * way.y,
                scale * rolled * direction.y + heading * way.x,
                drift * bias,
            ]
        };
        let covariance = &mut self.belief.covariance;
        for at in 0..STATES {
            let column = covariance.column(at);
            let moved = moves(column[HEADING], column[WHEELS] + column[ROLL], column[BIAS]);
            (0..3).for_each(|row| covariance[(row, at)] += moved[row]);
        }
        for at in 0..STATES {
            let row = covariance.row(at);
            let moved = moves(row[HEADING], row[WHEELS] + row[ROLL], row[BIAS]);
            (0..3).for_each(|column| covariance[(at, column)] += moved[column]);
        }
        covariance[(X, X)] += along * square(direction.x) + slide + 1e-8;
        covariance[(Y, Y)] += along * square(direction.y) + slide + 1e-8;
        covariance[(X, Y)] += along * direction.x * direction.y;
        covariance[(Y, X)] += along * direction.x * direction.y;
        let turn = match readings.turned_rad {
            Some(_) => square(turn_share * turned_rad) + square(turn_rad),
            None => square(wheel_share) * (square(turned_rad) + square(rolled / wheel_base)),
        };
        covariance[(HEADING, HEADING)] += turn;
    }

    /// A beam of the last step, from where the robot believes to have been at its moment.
    pub fn ray(&self, beam: &Return) -> Ray {
        let pose = &self.belief.pose;
        let back = beam.moment - 1.0;
        let heading = pose.rotation * rotation(back * self.belief.last.turned_rad);
        Ray {
            origin: pose.translation.vector + back * self.belief.last.way,
            direction: heading * beam.bearing * Vector2::x(),
            range: beam.range.map(|range| range * (1.0 + self.belief.ranges)),
        }
    }

    /// Corrects by a beam that ends on a line, unless it could end on two.
    fn take_in(&mut self, ray: &Ray) {
        let Some(range) = ray.range else {
            return;
        };
        let passes = |fit: &Fit| fit.distance() < self.params.gate;
        let x = self.fit(X, ray, range).filter(passes);
        let y = self.fit(Y, ray, range).filter(passes);
        match (x, y) {
            (Some(_), Some(_)) => {}
            (Some(fit), None) | (None, Some(fit)) => {
                let strain = &mut self.belief.strain[fit.axis];
                *strain = (*strain - 1.0).max(0.0);
                self.correct(&fit);
            }
            // On no line: along its way the robot is not where it believes to be.
            (None, None) => {
                let is_along_x = ray.direction.x.abs() > ray.direction.y.abs();
                self.doubt(if is_along_x { X } else { Y });
            }
        }
    }

    /// A beam disagrees with the position along an axis. One may be an outlier, but several in the
    /// last steps make the robot trust that position less.
    fn doubt(&mut self, axis: usize) {
        let strain = &mut self.belief.strain[axis];
        *strain += 1.0;
        if self.params.batch_check && *strain >= UNBEARABLE {
            *strain = 0.0;
            self.belief.covariance[(axis, axis)] += square(DOUBT);
        }
    }

    /// How a beam fits to the nearest line across an axis.
    fn fit(&self, axis: usize, ray: &Ray, range: f64) -> Option<Fit> {
        let along = ray.direction[axis];
        if along.abs() <= SHALLOW {
            return None;
        }
        let across = ray.direction[1 - axis];
        let measured = range / (1.0 + self.belief.ranges);
        let covariance = &self.belief.covariance;
        let deviation = self.assumed.range + self.assumed.range_share * range;
        let end = ray.origin[axis] + range * along;
        let sign = if axis == X { -1.0 } else { 1.0 };
        let by_heading = sign * range * across;
        let by_ranges = measured * along;
        let believed = covariance[(axis, axis)]
            + square(by_heading) * covariance[(HEADING, HEADING)]
            + square(by_ranges) * covariance[(RANGES, RANGES)]
            + 2.0 * by_heading * covariance[(axis, HEADING)]
            + 2.0 * by_ranges * covariance[(axis, RANGES)]
            + 2.0 * by_heading * by_ranges * covariance[(HEADING, RANGES)];
        let measured_badly =
            square(along * deviation) + square(across * range * self.assumed.beam_rad);
        Some(Fit {
            axis,
            residual: end.round() - end,
            by_heading,
            by_ranges,
            variance: believed + measured_badly,
        })
    }

    /// Moves the state so that the beam ends nearer to the line.
    fn correct(&mut self, fit: &Fit) {
        let covariance = &mut self.belief.covariance;
        let seen = covariance.column(fit.axis)
            + fit.by_heading * covariance.column(HEADING)
            + fit.by_ranges * covariance.column(RANGES);
        let gain = seen / fit.variance;
        *covariance -= gain * seen.transpose();
        let change = gain * fit.residual;
        self.belief.pose.translation.vector += Vector2::new(change[X], change[Y]);
        self.belief.pose.rotation *= cayley(change[HEADING]);
        self.belief.bias += change[BIAS];
        self.belief.wheels += change[WHEELS];
        self.belief.ranges += change[RANGES];
        self.belief.roll += change[ROLL];
    }
}
