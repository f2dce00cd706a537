//! Where the robot believes to be: an extended Kalman filter over wheels, gyro and lidar.
//!
//! It needs no map. All it knows of the world is that walls lie on the lines of the grid, so that
//! a beam ends on one: the distance to the nearest line is what it corrects by. On such a grid a
//! filter that is too sure of itself locks in one cell off, and no beam can tell. So it assumes
//! more noise than there is, and where several beams disagree with it, it trusts itself less
//! ([`EstimatorParams::batch_check`]). Lengths in metres, angles in radians.

mod fit;
mod predict;

use nalgebra::{Isometry2, Matrix3, SMatrix, SVector, UnitComplex, Vector2};
use serde::{Deserialize, Serialize};

use self::fit::Fit;
use super::angle::{ahead, rotation, square};
use super::assumed::Assumed;
use super::slip::{Slip, Verdict};
use crate::{EstimatorParams, Readings, Return, Robot, STEP_S};

/// Places in the state: position, heading, bias and scale of the gyro, scale of the wheels, scale of the
/// ranges, and by how much the wheels roll otherwise in this action.
const X: usize = 0;
const Y: usize = 1;
const HEADING: usize = 2;
const BIAS: usize = 3;
const GYRO: usize = 4;
const WHEELS: usize = 5;
const RANGES: usize = 6;
const ROLL: usize = 7;
const STATES: usize = 8;

/// A beam along an axis less than this (a cosine) says nothing about lines across that axis, but it may
/// end on one.
const SHALLOW: f64 = 0.25;
/// The squared distance, in units of the variance, up to which two beams agree: 3 deviations.
const AGREEING: f64 = 9.0;
/// A deviation of the position, in metres, from which on a beam is believed only if others agree with it:
/// the third.
const UNSURE: f64 = 0.1;
const ENOUGH: u32 = 3;
/// What a bump may add to the position, as a deviation in metres.
const BUMP_SLIDE: f64 = 0.02;
/// The deviation of the position, in metres, that is added where beams disagree with it.
const DOUBT: f64 = 0.08;
/// Wheels that speed up or brake may slip: deviation of the way as a share of by how much it differs
/// from that of the step before.
const LAG: f64 = 0.6;
/// When wheels turn out to have spun: deviation of the position as a share of how far it was off.
const SPIN: f64 = 0.5;
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
    /// By what share the robot turns farther than the gyro tells.
    gyro: f64,
    /// By what share the wheels roll farther than they count.
    wheels: f64,
    /// By what share ranges are longer than they are measured.
    ranges: f64,
    /// By what further share the wheels roll farther during this action.
    roll: f64,
    last: LastStep,
    /// Whether the wheels slip.
    slip: Slip,
    /// For so many steps it still takes into account that it may slip before it notices.
    wary: u32,
    /// How many more beams have lately disagreed than agreed with the position, along x and y.
    strain: [f64; 2],
    /// Over position, heading, bias, gyro, wheels, ranges and roll; symmetric to the bit.
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
    /// How far it moved along its heading if the floor is slippery.
    held: f64,
    /// By how much the wheels have rolled too far for a slippery floor since they began to.
    excess: f64,
}

/// The filter.
#[derive(Debug, Clone)]
pub(crate) struct Estimator {
    params: EstimatorParams,
    /// Distance between the lines of the grid.
    cell_size_m: f64,
    assumed: Assumed,
    belief: Belief,
    /// How far it turned back from the end of the last step to each of its beams.
    back: Vec<UnitComplex<f64>>,
    /// Along x and y: the last beams of this action that were taken to end on lines.
    witnesses: [ConsistencyCheck; 2],
}

/// Beams that were taken to end on lines across an axis, and agree.
#[derive(Debug, Clone, Copy, Default)]
struct ConsistencyCheck {
    /// How far from its line the last of them ended.
    residual: f64,
    /// How many of them there are.
    count: u32,
}

/// A beam from where the robot believes that it was sent: its origin, its direction, and its
/// range without the scale that the robot believes in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    /// In the grid frame.
    pub origin: Vector2<f64>,
    /// A unit vector.
    pub direction: Vector2<f64>,
    /// Minus infinity when something is too near to be measured; `None` when nothing came back.
    pub range: Option<f64>,
}

impl Estimator {
    /// A filter that knows nothing of its sensors yet, for a robot at the origin.
    pub fn new(robot: &Robot) -> Self {
        let assumed = Assumed::new(robot);
        let Assumed {
            bias,
            gyro,
            wheels,
            ranges,
            ..
        } = assumed;
        let variances = [0.0, 0.0, 0.0, bias, gyro, wheels, ranges, 0.0].map(square);
        Self {
            params: robot.estimator.clone(),
            cell_size_m: robot.cell_size_m,
            belief: Belief {
                pose: Isometry2::identity(),
                bias: 0.0,
                gyro: 0.0,
                wheels: 0.0,
                ranges: 0.0,
                roll: 0.0,
                last: LastStep::default(),
                slip: Slip::default(),
                wary: 0,
                strain: [0.0; 2],
                covariance: SMatrix::from_diagonal(&SVector::from(variances)),
            },
            assumed,
            back: Vec::new(),
            witnesses: [ConsistencyCheck::default(); 2],
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

    /// The estimated pose in the grid frame, in metres.
    pub fn pose(&self) -> Isometry2<f64> {
        self.belief.pose
    }

    /// The covariance of x, y and heading.
    pub fn covariance(&self) -> Matrix3<f64> {
        self.belief.covariance.fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// Speed along the heading in m/s, and turn rate in rad/s.
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
        self.witnesses = [ConsistencyCheck::default(); 2];
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
        let turned_rad = self.belief.last.turned_rad;
        let back = |beam: &Return| rotation((beam.moment - 1.0) * turned_rad);
        self.back.clear();
        self.back.extend(readings.beams.iter().map(back));
        for (number, beam) in readings.beams.iter().enumerate() {
            self.take_in(&self.ray(beam, self.back[number]));
        }
    }

    /// The beams of the last step, as the robot sees them at its end.
    pub fn rays(&self, beams: &[Return]) -> impl Iterator<Item = Ray> {
        let beams = beams.iter().zip(&self.back);
        beams.map(|(beam, &back)| self.ray(beam, back))
    }

    /// A beam of the last step, from where the robot believes to have been at its moment; since
    /// then it has turned by the inverse of `back`.
    pub fn ray(&self, beam: &Return, back: UnitComplex<f64>) -> Ray {
        let pose = &self.belief.pose;
        Ray {
            origin: pose.translation.vector + (beam.moment - 1.0) * self.belief.last.way,
            direction: ahead(pose.rotation * back * beam.bearing),
            range: beam.range_m.map(|range| range * (1.0 + self.belief.ranges)),
        }
    }

    /// Corrects by a beam that ends on a line, unless it could end on two.
    fn take_in(&mut self, ray: &Ray) {
        let Some(range) = ray.range.filter(|&range| range > 0.0) else {
            return;
        };
        let mut fits = self.fits(ray, range);
        if self.falls_back(ray, &fits) {
            fits = self.fits(ray, range);
        }
        let passes = |fit: &Fit| fit.distance < self.params.listener;
        match fits.map(|fit| Some(fit).filter(passes)) {
            [Some(_), Some(_)] => {}
            // It ends at a wall along which it runs: in a corridor, where it ends says nothing.
            [Some(fit), None] | [None, Some(fit)] if fit.is_shallow => {}
            [Some(fit), None] | [None, Some(fit)] => {
                let strain = &mut self.belief.strain[fit.axis];
                *strain = (*strain - 1.0).max(0.0);
                if self.is_believed(&fit) {
                    self.correct(&fit);
                }
            }
            // On no line: along its way the robot is not where it believes to be.
            [None, None] => {
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

    /// Does a beam fit better where the robot would be if its wheels had spun? True when this one
    /// decides it, and the robot sees that it is there.
    fn falls_back(&mut self, ray: &Ray, fits: &[Fit; 2]) -> bool {
        let Some(lag) = self.belief.slip.lag() else {
            return false;
        };
        let ahead = ahead(self.belief.pose.rotation);
        let origin = ray.origin - lag * ahead;
        let behind = fits.map(|fit| fit.from(origin, self.cell_size_m));
        let evidence = (self.misfit(fits) - self.misfit(&behind)) / 2.0;
        match self.belief.slip.weigh(evidence, &self.params) {
            Some(Verdict::Spun(lag)) => {
                self.fall_back(lag * ahead);
                return true;
            }
            Some(Verdict::Rolled) => self.belief.last.held = self.belief.last.forward,
            None => {}
        }
        false
    }

    /// The squared distance of a beam's end from the nearest line, in units of its variance; that
    /// of an outlier is the gate.
    fn misfit(&self, fits: &[Fit; 2]) -> f64 {
        let distances = fits.iter().map(|fit| fit.distance);
        distances.fold(self.params.listener, f64::min)
    }

    /// The robot is so far behind what it believed.
    fn fall_back(&mut self, way: Vector2<f64>) {
        self.belief.pose.translation.vector -= way;
        self.witnesses = [ConsistencyCheck::default(); 2];
        let doubt = (SPIN * way) * (SPIN * way).transpose();
        let mut position = self.belief.covariance.fixed_view_mut::<2, 2>(X, X);
        position += doubt;
    }
}
