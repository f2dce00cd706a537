//! Pose estimation: an extended Kalman filter over wheels, gyro and lidar.
//!
//! With a map ([`Field`]), it corrects by the distance of a beam's end to the nearest surface.
//! Without one, it only assumes that walls are on the lines of the grid, so that every beam ends on
//! a line, and corrects by the distance to the nearest line. On such a grid an
//! overconfident filter can lock in one cell off, and no beam can reveal the error. The filter
//! therefore assumes more noise than there is, and inflates its covariance where several beams
//! disagree with it ([`EstimatorParams::batch_check`]). Lengths in metres, angles in radians.

mod fit;
mod predict;

use std::sync::Arc;

use nalgebra::{Isometry2, Matrix3, SMatrix, SVector, UnitComplex, Vector2};

use self::fit::Fit;
use super::angle::{ahead, rotation, square};
use super::assumed::Assumed;
use super::field::Field;
use super::wheel_slip::{Verdict, WheelSlip};
use crate::{EstimatorParams, Readings, Return, RobotParams, STEP_S};

/// Indices of the state: position, heading, bias and scale of the gyro, scale of the wheels, scale
/// of the ranges, and the extra scale of the wheels during this action.
const X: usize = 0;
const Y: usize = 1;
const HEADING: usize = 2;
const BIAS: usize = 3;
const GYRO: usize = 4;
const WHEELS: usize = 5;
const RANGES: usize = 6;
const ROLL: usize = 7;
const STATES: usize = 8;

/// The smallest component of a beam along the normal of a wall (a cosine) that gives information
/// about the wall. Shallower beams may still end at it.
const SHALLOW: f64 = 0.25;
/// The squared distance, in units of the variance, up to which two beams agree: 3 deviations.
const AGREEING: f64 = 9.0;
/// The deviation of the position, in metres, above which a beam is accepted only if others agree
/// with it: it must be the third.
const UNCERTAIN: f64 = 0.1;
const MIN_AGREEING: u32 = 3;
/// The deviation of the position that a bump adds, in metres.
const BUMP_SLIDE: f64 = 0.02;
/// The deviation of the position that is added where beams disagree with it, in metres.
const INFLATION: f64 = 0.08;
/// The slip of accelerating or braking wheels: the deviation of the distance, as a share of its
/// change since the step before.
const LAG: f64 = 0.6;
/// The deviation of the position after detected wheel spin, as a share of the correction.
const SPIN: f64 = 0.5;
/// The deviation of a pose from another localiser, in metres and in radians.
const TOLD_OFF: f64 = 0.01;
/// The surplus of disagreeing over agreeing beams that triggers a covariance inflation ...
const MAX_STRAIN: f64 = 2.5;
/// ... and the share of this surplus that carries over from step to step.
const STRAIN_DECAY: f64 = 0.7;

/// The filter's state.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FilterState {
    pose: Isometry2<f64>,
    /// The gyro bias in rad/s.
    bias: f64,
    /// The scale error of the gyro: the share by which the robot turns farther than measured.
    gyro: f64,
    /// The scale error of the wheels: the share by which they roll farther than counted.
    wheels: f64,
    /// The scale error of the lidar: the share by which ranges are longer than measured.
    ranges: f64,
    /// The further scale error of the wheels during this action.
    roll: f64,
    last: LastStep,
    /// The wheel-slip detector.
    slip: WheelSlip,
    /// The number of steps for which undetected slip is still considered possible.
    wary: u32,
    /// The recent surplus of disagreeing over agreeing beams, along x and y.
    strain: [f64; 2],
    /// Over position, heading, bias, gyro, wheels, ranges and roll; exactly symmetric.
    covariance: SMatrix<f64, STATES, STATES>,
}

/// The estimated motion in the last step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct LastStep {
    way: Vector2<f64>,
    turned_rad: f64,
    forward: f64,
    /// The distance that the wheels counted.
    rolled: f64,
    /// The distance along the heading if the floor is slippery.
    held: f64,
    /// The distance that the wheels have rolled too far for a slippery floor, since they started
    /// to.
    excess: f64,
}

/// The filter.
#[derive(Debug, Clone)]
pub(crate) struct Estimator {
    params: EstimatorParams,
    /// The distance between the lines of the grid.
    cell_size_m: f64,
    /// The map; `None` for walls on the lines of the grid.
    map: Option<Arc<dyn Field>>,
    assumed: Assumed,
    filter: FilterState,
    /// The rotation from the end of the last step back to each of its beams.
    back: Vec<UnitComplex<f64>>,
    /// Along x and y: the last beams of this action that were accepted as ending at walls.
    consistency_checks: [ConsistencyCheck; 2],
}

/// A run of beams that end at walls across an axis, and agree.
#[derive(Debug, Clone, Copy, Default)]
struct ConsistencyCheck {
    /// The distance of the last beam's end from its wall.
    residual: f64,
    /// The number of beams.
    count: u32,
}

/// A beam from its estimated origin: origin, direction, and range without the estimated scale
/// error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    /// The origin in the grid frame.
    pub origin: Vector2<f64>,
    /// The direction as a unit vector.
    pub direction: Vector2<f64>,
    /// The range. Minus infinity when something is too near to be measured; `None` when nothing
    /// came back.
    pub range: Option<f64>,
}

impl Estimator {
    /// Creates a filter with uncalibrated sensors, for a robot at the origin.
    pub fn new(robot: &RobotParams) -> Self {
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
            map: None,
            filter: FilterState {
                pose: Isometry2::identity(),
                bias: 0.0,
                gyro: 0.0,
                wheels: 0.0,
                ranges: 0.0,
                roll: 0.0,
                last: LastStep::default(),
                slip: WheelSlip::default(),
                wary: 0,
                strain: [0.0; 2],
                covariance: SMatrix::from_diagonal(&SVector::from(variances)),
            },
            assumed,
            back: Vec::new(),
            consistency_checks: [ConsistencyCheck::default(); 2],
        }
    }

    /// Corrects the pose by a map from now on.
    pub fn use_map(&mut self, map: Arc<dyn Field>) {
        self.map = Some(map);
    }

    /// Returns true if the robot has a map.
    pub fn has_map(&self) -> bool {
        self.map.is_some()
    }

    /// Puts the robot down at rest, at `pose` with these deviations: in metres, and in radians. The
    /// calibration of the sensors stays.
    pub fn put_down(&mut self, pose: Isometry2<f64>, [off_m, off_rad]: [f64; 2]) {
        self.place(pose, [off_m, off_m, off_rad]);
        self.filter.slip = WheelSlip::default();
        self.filter.wary = 0;
        self.filter.strain = [0.0; 2];
        self.filter.last = LastStep::default();
    }

    /// Sets the pose, with deviations of x, y and heading that depend on nothing else.
    fn place(&mut self, pose: Isometry2<f64>, deviations: [f64; 3]) {
        let FilterState { covariance, .. } = &mut self.filter;
        for (at, deviation) in [X, Y, HEADING].into_iter().zip(deviations) {
            covariance.row_mut(at).fill(0.0);
            covariance.column_mut(at).fill(0.0);
            covariance[(at, at)] = square(deviation);
        }
        self.filter.pose = pose;
    }

    /// Returns the estimated pose in the grid frame, in metres.
    pub fn pose(&self) -> Isometry2<f64> {
        self.filter.pose
    }

    /// Returns the covariance of x, y and heading.
    pub fn covariance(&self) -> Matrix3<f64> {
        self.filter.covariance.fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// Returns the speed along the heading in m/s, and the turn rate in rad/s.
    pub fn speeds(&self) -> (f64, f64) {
        (
            self.filter.last.forward / STEP_S,
            self.filter.last.turned_rad / STEP_S,
        )
    }

    /// Returns true if wheel slip was detected recently.
    pub fn slips(&self) -> bool {
        self.filter.slip.is_detected()
    }

    /// Returns the way in metres and the turn in radians of the last step.
    pub fn last_motion(&self) -> (Vector2<f64>, f64) {
        (self.filter.last.way, self.filter.last.turned_rad)
    }

    /// Returns the factor by which ranges are longer than measured.
    pub fn range_scale(&self) -> f64 {
        1.0 + self.filter.ranges
    }

    /// Returns the whole state.
    #[cfg(test)]
    pub fn filter(&self) -> &FilterState {
        &self.filter
    }

    /// Begins an action, in which the wheels have a new scale error.
    pub fn begin_action(&mut self) {
        self.filter.roll = 0.0;
        self.consistency_checks = [ConsistencyCheck::default(); 2];
        let covariance = &mut self.filter.covariance;
        covariance.row_mut(ROLL).fill(0.0);
        covariance.column_mut(ROLL).fill(0.0);
        // The mean of two wheels has half of the variance.
        covariance[(ROLL, ROLL)] = square(self.assumed.roll_bias) / 2.0;
    }

    /// Updates the state with the readings of a step. A pose from another localiser replaces the
    /// correction by the beams.
    pub fn step(&mut self, readings: &Readings<'_>) {
        self.predict(readings);
        self.filter.strain = self.filter.strain.map(|strain| STRAIN_DECAY * strain);
        let turned_rad = self.filter.last.turned_rad;
        let back = |beam: &Return| rotation((beam.moment - 1.0) * turned_rad);
        self.back.clear();
        self.back.extend(readings.beams.iter().map(back));
        if let Some(pose) = readings.told {
            self.place(pose, [TOLD_OFF; 3]);
            return;
        }
        for (number, beam) in readings.beams.iter().enumerate() {
            self.take_in(&self.ray(beam, self.back[number]));
        }
    }

    /// Returns the beams of the last step, as estimated at its end.
    pub fn rays(&self, beams: &[Return]) -> impl Iterator<Item = Ray> {
        let beams = beams.iter().zip(&self.back);
        beams.map(|(beam, &back)| self.ray(beam, back))
    }

    /// Returns a beam of the last step, from the estimated pose at its moment. Since then the robot
    /// has turned by the inverse of `back`.
    pub fn ray(&self, beam: &Return, back: UnitComplex<f64>) -> Ray {
        let pose = &self.filter.pose;
        Ray {
            origin: pose.translation.vector + (beam.moment - 1.0) * self.filter.last.way,
            direction: ahead(pose.rotation * back * beam.bearing),
            range: beam.range_m.map(|range| range * self.range_scale()),
        }
    }

    /// Corrects the state by a beam that ends at a wall, unless it could end at two.
    fn take_in(&mut self, ray: &Ray) {
        let Some(range) = ray.range.filter(|&range| range > 0.0) else {
            return;
        };
        let mut fits = self.fits(ray, range);
        if self.falls_back(ray, range, &fits) {
            fits = self.fits(ray, range);
        }
        let passes = |fit: &Fit| fit.distance < self.params.gate;
        match fits.map(|fit| fit.filter(passes)) {
            [Some(_), Some(_)] => {}
            // The beam ends at a wall that it runs along. In a corridor, its end gives no
            // information.
            [Some(fit), None] | [None, Some(fit)] if fit.is_shallow => {}
            [Some(fit), None] | [None, Some(fit)] => {
                let strain = &mut self.filter.strain[fit.axis];
                *strain = (*strain - 1.0).max(0.0);
                if self.is_accepted(&fit) {
                    self.correct(&fit);
                }
            }
            // The beam ends at no wall: the estimated position along the beam is wrong.
            [None, None] => {
                let is_along_x = ray.direction.x.abs() > ray.direction.y.abs();
                self.inflate(if is_along_x { X } else { Y });
            }
        }
    }

    /// Handles a beam that disagrees with the position along an axis. A single beam may be an
    /// outlier. Several in the last steps inflate the covariance of that position.
    fn inflate(&mut self, axis: usize) {
        let strain = &mut self.filter.strain[axis];
        *strain += 1.0;
        if self.params.batch_check && *strain >= MAX_STRAIN {
            *strain = 0.0;
            self.filter.covariance[(axis, axis)] += square(INFLATION);
        }
    }

    /// Tests whether a beam fits better at the position where the robot would be if its wheels had
    /// spun. Returns true if this beam decides the test in favour of that position.
    fn falls_back(&mut self, ray: &Ray, range: f64, fits: &[Option<Fit>; 2]) -> bool {
        let Some(lag) = self.filter.slip.lag() else {
            return false;
        };
        let ahead = ahead(self.filter.pose.rotation);
        let behind = Ray {
            origin: ray.origin - lag * ahead,
            ..*ray
        };
        let behind = self.fits(&behind, range);
        let evidence = (self.misfit(fits) - self.misfit(&behind)) / 2.0;
        match self.filter.slip.weigh(evidence, &self.params) {
            Some(Verdict::Spun(lag)) => {
                self.fall_back(lag * ahead);
                return true;
            }
            Some(Verdict::Rolled) => self.filter.last.held = self.filter.last.forward,
            None => {}
        }
        false
    }

    /// Returns the squared distance of a beam's end from the nearest wall, in units of its
    /// variance, limited to the gate for outliers.
    fn misfit(&self, fits: &[Option<Fit>; 2]) -> f64 {
        let distances = fits.iter().flatten().map(|fit| fit.distance);
        distances.fold(self.params.gate, f64::min)
    }

    /// Moves the estimate back by `way`.
    fn fall_back(&mut self, way: Vector2<f64>) {
        self.filter.pose.translation.vector -= way;
        self.consistency_checks = [ConsistencyCheck::default(); 2];
        let inflation = (SPIN * way) * (SPIN * way).transpose();
        let mut position = self.filter.covariance.fixed_view_mut::<2, 2>(X, X);
        position += inflation;
    }
}
