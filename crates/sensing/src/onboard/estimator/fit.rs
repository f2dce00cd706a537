//! How well beams fit the lines of the grid.

use nalgebra::Vector2;

use super::{
    AGREEING, BIAS, Estimator, GYRO, HEADING, MIN_AGREEING, RANGES, ROLL, Ray, SHALLOW, UNCERTAIN,
    WHEELS, X, Y,
};
use crate::onboard::angle::{ahead, cayley, square};
use crate::whole::round;

/// The fit of a beam to the nearest line across one axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    pub axis: usize,
    /// True if the beam is nearly parallel to the line, and gives no distance to it.
    pub is_shallow: bool,
    /// The distance that the beam reaches along the axis.
    reach: f64,
    /// The distance from the end of the beam to the line.
    residual: f64,
    /// The square of the residual in units of its variance.
    pub distance: f64,
    /// The derivatives of the beam's end by heading and by the scale of ranges; the derivative by
    /// the axis is 1.
    by_heading: f64,
    by_ranges: f64,
    /// The variance of the residual ...
    variance: f64,
    /// ... and its part that does not come from the position, whose error other beams share.
    own_variance: f64,
}

impl Fit {
    /// Returns the fit of the same beam if it starts at `origin`, in a grid with lines every
    /// `cell_size_m`.
    pub fn from(self, origin: Vector2<f64>, cell_size_m: f64) -> Self {
        let end = origin[self.axis] + self.reach;
        let residual = round(end / cell_size_m) * cell_size_m - end;
        Self {
            residual,
            distance: residual * residual / self.variance,
            ..self
        }
    }
}

impl Estimator {
    /// Returns the fits of a beam to the nearest lines across both axes.
    pub(super) fn fits(&self, ray: &Ray, range: f64) -> [Fit; 2] {
        let measured = range / (1.0 + self.filter.ranges);
        [X, Y].map(|axis| self.fit(axis, ray, range, measured))
    }

    /// Returns the fit of a beam to the nearest line across an axis. `measured` is its range
    /// without the estimated scale.
    fn fit(&self, axis: usize, ray: &Ray, range: f64, measured: f64) -> Fit {
        let along = ray.direction[axis];
        let across = ray.direction[1 - axis];
        let covariance = &self.filter.covariance;
        let deviation = self.assumed.range + self.assumed.range_share * range;
        let sign = if axis == X { -1.0 } else { 1.0 };
        let by_heading = sign * range * across;
        let by_ranges = measured * along;
        let turned_and_scaled = square(by_heading) * covariance[(HEADING, HEADING)]
            + square(by_ranges) * covariance[(RANGES, RANGES)];
        let state_variance = covariance[(axis, axis)]
            + turned_and_scaled
            + 2.0 * by_heading * covariance[(axis, HEADING)]
            + 2.0 * by_ranges * covariance[(axis, RANGES)]
            + 2.0 * by_heading * by_ranges * covariance[(HEADING, RANGES)];
        let measurement_variance =
            square(along * deviation) + square(across * range * self.assumed.beam_rad);
        let fit = Fit {
            axis,
            is_shallow: along.abs() <= SHALLOW,
            reach: range * along,
            residual: 0.0,
            distance: 0.0,
            by_heading,
            by_ranges,
            variance: state_variance + measurement_variance,
            own_variance: turned_and_scaled + measurement_variance,
        };
        fit.from(ray.origin, self.cell_size_m)
    }

    /// Returns true if a beam is accepted as ending on a line across an axis. Outliers can end on
    /// lines, too. Where the position is uncertain, a single one would make the robot certain of a
    /// wrong position, so the last beams of this action must agree there.
    pub(super) fn is_accepted(&mut self, fit: &Fit) -> bool {
        let check = &mut self.consistency_checks[fit.axis];
        let apart = square(fit.residual - check.residual);
        let agree = check.count > 0 && apart < AGREEING * 2.0 * fit.own_variance;
        check.count = if agree { check.count + 1 } else { 1 };
        check.residual = fit.residual;
        let is_sure = self.filter.covariance[(fit.axis, fit.axis)] < square(UNCERTAIN);
        is_sure || check.count >= MIN_AGREEING
    }

    /// Moves the state so that the beam ends nearer to the line.
    pub(super) fn correct(&mut self, fit: &Fit) {
        let covariance = &mut self.filter.covariance;
        let seen = covariance.column(fit.axis)
            + fit.by_heading * covariance.column(HEADING)
            + fit.by_ranges * covariance.column(RANGES);
        // The outer product of a vector with itself is exactly symmetric. Plain arrays let the
        // compiler vectorise the loop.
        let root = seen / fit.variance.sqrt();
        for (column, along) in covariance.data.0.iter_mut().zip(root.iter()) {
            for (value, across) in column.iter_mut().zip(root.iter()) {
                *value -= across * along;
            }
        }
        let change = seen * (fit.residual / fit.variance);
        let moved = Vector2::new(change[X], change[Y]);
        self.filter.pose.translation.vector += moved;
        let checks = self.consistency_checks.iter_mut().zip(moved.iter());
        checks.for_each(|(check, moved)| check.residual -= moved);
        let ahead = ahead(self.filter.pose.rotation);
        self.filter.slip.correct(moved.dot(&ahead));
        self.filter.pose.rotation *= cayley(change[HEADING]);
        self.filter.bias += change[BIAS];
        self.filter.gyro += change[GYRO];
        self.filter.wheels += change[WHEELS];
        self.filter.ranges += change[RANGES];
        self.filter.roll += change[ROLL];
    }
}
