//! Where the robot believes to be: an extended Kalman filter over wheels, gyro and lidar.
//!
//! It needs no map. All it knows of the world is that walls lie on the lines of the grid, so that
//! a beam ends on one: the distance to the nearest line is what it corrects by. On such a grid a
//! filter that is too sure of itself locks in one cell off, and no beam can tell. So it assumes
//! more noise than there is, and when most beams of a step disagree it trusts itself less
//! ([`EstimatorParams::batch_check`]). Lengths in cells, angles in radians.

use nalgebra::{Complex, Isometry2, Matrix3, Matrix6, UnitComplex, Vector2, Vector6};
use serde::{Deserialize, Serialize};

use crate::{EstimatorParams, Readings, Return, Robot, STEP_S};

/// Places in the state: position, heading, gyro bias, scale of the wheels, scale of the ranges.
const X: usize = 0;
const Y: usize = 1;
const HEADING: usize = 2;
const BIAS: usize = 3;
const WHEELS: usize = 4;
const RANGES: usize = 5;

/// A beam along an axis less than this (a cosine) says nothing about lines across that axis.
const SHALLOW: f64 = 0.25;
/// What a bump may add to the position, as a deviation.
const BUMP_SLIDE: f64 = 0.02;
/// What is added when most beams disagree: deviations of position and heading.
const DOUBT: f64 = 0.08;
const DOUBT_RAD: f64 = 0.03;

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
    /// Over position, heading, bias, wheels and ranges.
    covariance: Matrix6<f64>,
}

/// How noisy the filter assumes its sensors to be: deviations.
#[derive(Debug, Clone)]
struct Assumed {
    range: f64,
    range_share: f64,
    beam_rad: f64,
    roll_share: f64,
    turn_share: f64,
    turn_rad: f64,
    bias: f64,
    wheels: f64,
    ranges: f64,
    wheel_base: f64,
}

impl Assumed {
    /// The data sheets of the sensors at their noise level, times the caution. A thousandth is
    /// left where there is no noise, because the world is computed with rounding.
    fn new(robot: &Robot) -> Self {
        let times = robot.noise * robot.estimator.caution;
        let of = |deviation: f64, least: f64| (times * deviation).max(least);
        let Robot {
            lidar,
            encoders,
            gyro,
            ..
        } = robot;
        Self {
            range: of(lidar.noise_m + lidar.offset_m, 0.002),
            range_share: of(lidar.noise_share, 0.001),
            beam_rad: of(lidar.jitter_rad, 0.002),
            roll_share: of(robot.wheel_deviation, 0.01),
            turn_share: of(gyro.scale, 0.002),
            turn_rad: of(gyro.noise_radps * STEP_S, 1e-4),
            bias: of(gyro.bias_radps, 1e-4),
            wheels: of(encoders.scale, 0.002),
            ranges: of(lidar.scale, 0.001),
            wheel_base: robot.wheel_base,
        }
    }
}

/// How the robot moved in the last step, as far as it knows.
#[derive(Debug, Clone, Copy, Default)]
struct LastStep {
    way: Vector2<f64>,
    turned_rad: f64,
    forward: f64,
}

/// The filter.
#[derive(Debug, Clone)]
pub(crate) struct Estimator {
    params: EstimatorParams,
    assumed: Assumed,
    belief: Belief,
    last: LastStep,
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
        let deviations = [0.0, 0.0, 0.0, assumed.bias, assumed.wheels, assumed.ranges];
        let variances = Vector6::from(deviations.map(|deviation| deviation * deviation));
        Self {
            params: robot.estimator.clone(),
            belief: Belief {
                pose: Isometry2::identity(),
                bias: 0.0,
                wheels: 0.0,
                ranges: 0.0,
                covariance: Matrix6::from_diagonal(&variances),
            },
            assumed,
            last: LastStep::default(),
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
        self.last = LastStep::default();
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
        (self.last.forward / STEP_S, self.last.turned_rad / STEP_S)
    }

    /// The whole state.
    pub fn belief(&self) -> &Belief {
        &self.belief
    }

    /// Goes back to a state between two actions.
    pub fn set_belief(&mut self, belief: Belief) {
        self.belief = belief;
        self.last = LastStep::default();
    }

    /// Takes in what the sensors told about a step.
    pub fn step(&mut self, readings: &Readings<'_>) {
        self.predict(readings);
        if self.params.batch_check && self.most_disagree(readings.beams) {
            self.doubt();
        }
        for beam in readings.beams {
            if let Some(fit) = self.fit(&self.ray(beam)) {
                self.correct(&fit);
            }
        }
    }

    /// Moves by what wheels and gyro tell.
    fn predict(&mut self, readings: &Readings<'_>) {
        let Assumed {
            roll_share,
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
        let forward = (1.0 + self.belief.wheels) * rolled;
        let half = rotation(turned_rad / 2.0);
        let middle = self.belief.pose.rotation * half;
        let way = middle * Vector2::new(forward, 0.0);
        self.belief.pose.translation.vector += way;
        self.belief.pose.rotation = UnitComplex::new_normalize((middle * half).into_inner());
        self.last = LastStep {
            way,
            turned_rad,
            forward,
        };

        let mut jacobian = Matrix6::identity();
        jacobian[(X, HEADING)] = -way.y;
        jacobian[(Y, HEADING)] = way.x;
        jacobian[(X, WHEELS)] = rolled * middle.re;
        jacobian[(Y, WHEELS)] = rolled * middle.im;
        if readings.turned_rad.is_some() {
            jacobian[(HEADING, BIAS)] = -STEP_S;
        }
        let covariance = &mut self.belief.covariance;
        *covariance = jacobian * *covariance * jacobian.transpose();
        // A wheel that slips turns the robot less than it counts: then the way is wrong by as much.
        let slipped = (by_wheels - turned_rad) * wheel_base / 2.0;
        let along = square(roll_share * rolled) + square(0.25 * slipped) + 1e-8;
        let slide = if bumped {
            square(rolled) + square(BUMP_SLIDE)
        } else {
            0.0
        };
        let direction = middle * Vector2::x();
        covariance[(X, X)] += along * square(direction.x) + slide + 1e-8;
        covariance[(Y, Y)] += along * square(direction.y) + slide + 1e-8;
        covariance[(X, Y)] += along * direction.x * direction.y;
        covariance[(Y, X)] += along * direction.x * direction.y;
        let turn = match readings.turned_rad {
            Some(_) => square(turn_share * turned_rad) + square(turn_rad),
            None => square(roll_share * turned_rad) + square(roll_share * rolled / wheel_base),
        };
        covariance[(HEADING, HEADING)] += turn;
    }

    /// A beam of the last step, from where the robot believes to have been at its moment.
    pub fn ray(&self, beam: &Return) -> Ray {
        let pose = &self.belief.pose;
        let back = beam.moment - 1.0;
        let heading = pose.rotation * rotation(back * self.last.turned_rad);
        Ray {
            origin: pose.translation.vector + back * self.last.way,
            direction: heading * beam.bearing * Vector2::x(),
            range: beam.range.map(|range| range * (1.0 + self.belief.ranges)),
        }
    }

    /// Do more than half of the beams that came back, and at least two, end on no line?
    fn most_disagree(&self, beams: &[Return]) -> bool {
        let (mut failed, mut came_back) = (0, 0);
        for beam in beams.iter().filter(|beam| beam.range.is_some()) {
            let [x, y] = self.fits(&self.ray(beam));
            let passes = |fit: &Fit| fit.distance() < self.params.gate;
            came_back += 1;
            failed += u32::from(![x, y].iter().flatten().any(passes));
        }
        failed >= 2 && 2 * failed > came_back
    }

    /// Trusts the pose less.
    fn doubt(&mut self) {
        let covariance = &mut self.belief.covariance;
        covariance[(X, X)] += square(DOUBT);
        covariance[(Y, Y)] += square(DOUBT);
        covariance[(HEADING, HEADING)] += square(DOUBT_RAD);
    }

    /// The line that a beam ends on; `None` when it ends on none, or could end on two.
    fn fit(&self, ray: &Ray) -> Option<Fit> {
        let passes = |fit: &Fit| fit.distance() < self.params.gate;
        let [x, y] = self.fits(ray).map(|fit| fit.filter(passes));
        match (x, y) {
            (Some(_), Some(_)) => None,
            (one, other) => one.or(other),
        }
    }

    /// How a beam fits to the nearest lines across both axes.
    fn fits(&self, ray: &Ray) -> [Option<Fit>; 2] {
        let Some(range) = ray.range else {
            return [None; 2];
        };
        let measured = range / (1.0 + self.belief.ranges);
        let covariance = &self.belief.covariance;
        let Assumed {
            range: least,
            range_share,
            beam_rad,
            ..
        } = self.assumed;
        let deviation = least + range_share * range;
        let direction = [ray.direction.x, ray.direction.y];
        [X, Y].map(|axis| {
            let along = direction[axis];
            if along.abs() <= SHALLOW {
                return None;
            }
            let across = direction[1 - axis];
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
            let measured_badly = square(along * deviation) + square(across * range * beam_rad);
            Some(Fit {
                axis,
                residual: end.round() - end,
                by_heading,
                by_ranges,
                variance: believed + measured_badly,
            })
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
    }
}

fn square(number: f64) -> f64 {
    number * number
}

/// The rotation by an angle.
fn rotation(angle_rad: f64) -> UnitComplex<f64> {
    let (sine, cosine) = libm::sincos(angle_rad);
    UnitComplex::new_unchecked(Complex::new(cosine, sine))
}

/// The rotation by a small angle, without sine and cosine (Cayley's formula).
fn cayley(angle_rad: f64) -> UnitComplex<f64> {
    let quarter = angle_rad * angle_rad / 4.0;
    let over = 1.0 + quarter;
    UnitComplex::new_unchecked(Complex::new((1.0 - quarter) / over, angle_rad / over))
}
