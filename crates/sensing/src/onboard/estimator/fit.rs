//! How beams fit to the lines of the grid.

use nalgebra::Vector2;

use super::{
    AGREEING, BIAS, ENOUGH, Estimator, GYRO, HEADING, RANGES, ROLL, Ray, SHALLOW, UNSURE, WHEELS,
    X, Y,
};
use crate::onboard::angle::{ahead, cayley, square};
use crate::whole::round;

/// How a beam fits to the nearest line across one axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    pub axis: usize,
    /// Does it run so nearly along the line that it cannot tell how far away that is?
    pub is_shallow: bool,
    /// How far the beam reaches along the axis.
    reach: f64,
    /// From where the beam ends to the line.
    residual: f64,
    /// Its square in units of its variance.
    pub distance: f64,
    /// The derivatives of the end by heading and by the scale of ranges; by the axis it is 1.
    by_heading: f64,
    by_ranges: f64,
    /// The variance of the residual ...
    variance: f64,
    /// ... and of it what does not come from the position, in which other beams are as wrong.
    own_variance: f64,
}

impl Fit {
    /// How the same beam fits if it begins at `origin`, in a grid with lines every `cell_size_m`.
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
    /// How a beam fits to the nearest lines across both axes.
    pub(super) fn fits(&self, ray: &Ray, range: f64) -> [Fit; 2] {
        let measured = range / (1.0 + self.belief.ranges);
        [X, Y].map(|axis| self.fit(axis, ray, range, measured))
    }

    /// How a beam fits to the nearest line across an axis; `measured` is its range without the
    /// scale that the robot believes in.
    fn fit(&self, axis: usize, ray: &Ray, range: f64, measured: f64) -> Fit {
        let along = ray.direction[axis];
        let across = ray.direction[1 - axis];
        let covariance = &self.belief.covariance;
        let deviation = self.assumed.range + self.assumed.range_share * range;
        let sign = if axis == X { -1.0 } else { 1.0 };
        let by_heading = sign * range * across;
        let by_ranges = measured * along;
        let turned_and_scaled = square(by_heading) * covariance[(HEADING, HEADING)]
            + square(by_ranges) * covariance[(RANGES, RANGES)];
        let believed = covariance[(axis, axis)]
            + turned_and_scaled
            + 2.0 * by_heading * covariance[(axis, HEADING)]
            + 2.0 * by_ranges * covariance[(axis, RANGES)]
            + 2.0 * by_heading * by_ranges * covariance[(HEADING, RANGES)];
        let measured_badly =
            square(along * deviation) + square(across * range * self.assumed.beam_rad);
        let fit = Fit {
            axis,
            is_shallow: along.abs() <= SHALLOW,
            reach: range * along,
            residual: 0.0,
            distance: 0.0,
            by_heading,
            by_ranges,
            variance: believed + measured_badly,
            own_variance: turned_and_scaled + measured_badly,
        };
        fit.from(ray.origin, self.cell_size_m)
    }

    /// Is a beam to be believed that is taken to end on a line across an axis? Where the position is
    /// unsure, outliers end on lines, too, and one would make the robot sure of a wrong place: there the
    /// last such beams of this action must agree.
    pub(super) fn is_believed(&mut self, fit: &Fit) -> bool {
        let consistency_check = &mut self.witnesses[fit.axis];
        let apart = square(fit.residual - consistency_check.residual);
        let agree = consistency_check.count > 0 && apart < AGREEING * 2.0 * fit.own_variance;
        consistency_check.count = if agree {
            consistency_check.count + 1
        } else {
            1
        };
        consistency_check.residual = fit.residual;
        let is_sure = self.belief.covariance[(fit.axis, fit.axis)] < square(UNSURE);
        is_sure || consistency_check.count >= ENOUGH
    }

    /// Moves the state so that the beam ends nearer to the line.
    pub(super) fn correct(&mut self, fit: &Fit) {
        let covariance = &mut self.belief.covariance;
        let seen = covariance.column(fit.axis)
            + fit.by_heading * covariance.column(HEADING)
            + fit.by_ranges * covariance.column(RANGES);
        // The product of a vector with itself is symmetric to the bit. As plain arrays, of which the
        // compiler makes vectors.
        let root = seen / fit.variance.sqrt();
        for (column, along) in covariance.data.0.iter_mut().zip(root.iter()) {
            for (value, across) in column.iter_mut().zip(root.iter()) {
                *value -= across * along;
            }
        }
        let change = seen * (fit.residual / fit.variance);
        let moved = Vector2::new(change[X], change[Y]);
        self.belief.pose.translation.vector += moved;
        let witnesses = self.witnesses.iter_mut().zip(moved.iter());
        witnesses.for_each(|(consistency_check, moved)| consistency_check.residual -= moved);
        let ahead = ahead(self.belief.pose.rotation);
        self.belief.slip.correct(moved.dot(&ahead));
        self.belief.pose.rotation *= cayley(change[HEADING]);
        self.belief.bias += change[BIAS];
        self.belief.gyro += change[GYRO];
        self.belief.wheels += change[WHEELS];
        self.belief.ranges += change[RANGES];
        self.belief.roll += change[ROLL];
    }
}
