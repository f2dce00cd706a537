//! How well beams fit the walls.

use nalgebra::Vector2;

use super::{
    AGREEING, BIAS, Estimator, GYRO, HEADING, MIN_AGREEING, RANGES, ROLL, Ray, SHALLOW, UNCERTAIN,
    WHEELS, X, Y,
};
use crate::onboard::angle::{ahead, cayley, square};
use crate::onboard::field::Field;
use crate::whole::round;

/// The fit of a beam to a wall.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    /// The axis that is nearer to the normal.
    pub axis: usize,
    /// The unit vector across the wall, in the positive direction of the axis.
    normal: Vector2<f64>,
    /// True if the beam is nearly parallel to the wall, and gives no distance to it.
    pub is_shallow: bool,
    /// The distance from the end of the beam to the wall, along the normal.
    residual: f64,
    /// The square of the residual in units of its variance.
    pub distance: f64,
    /// The derivatives of the beam's end along the normal by heading and by the scale of ranges;
    /// the derivatives by the position are the normal.
    by_heading: f64,
    by_ranges: f64,
    /// The variance of the residual ...
    variance: f64,
    /// ... and its part that does not come from the position, whose error other beams share.
    own_variance: f64,
}

/// A wall across a beam: the unit vector across it, the distance from the end of the beam to it
/// along this vector, and the deviation of the wall from the map.
struct Wall {
    normal: Vector2<f64>,
    residual: f64,
    deviation: f64,
    /// The covariances of the position along the normal: with itself, the heading, and the scale
    /// of ranges.
    covariances: [f64; 3],
}

impl Estimator {
    /// Returns the fits of a beam to the surface nearest to its end, or without a map to the
    /// nearest lines across both axes.
    pub(super) fn fits(&self, ray: &Ray, range: f64) -> [Option<Fit>; 2] {
        let end = ray.origin + range * ray.direction;
        match &self.map {
            Some(map) => [
                self.wall_of(map.as_ref(), ray, end)
                    .map(|wall| self.fit(&wall, ray, range)),
                None,
            ],
            None => [X, Y].map(|axis| {
                let wall = self.line(axis, end[axis]);
                Some(self.fit(&wall, ray, range))
            }),
        }
    }

    /// Returns the nearest line across an axis for a beam that ends at `at` metres along the axis.
    fn line(&self, axis: usize, at: f64) -> Wall {
        let covariance = &self.filter.covariance;
        Wall {
            normal: match axis {
                X => Vector2::x(),
                _ => Vector2::y(),
            },
            residual: round(at / self.cell_size_m) * self.cell_size_m - at,
            deviation: 0.0,
            covariances: [axis, HEADING, RANGES].map(|column| covariance[(axis, column)]),
        }
    }

    /// Returns the wall at which a beam ends, by a map; `None` if no surface near its end faces the
    /// robot.
    fn wall_of(&self, map: &dyn Field, ray: &Ray, end: Vector2<f64>) -> Option<Wall> {
        let surface = map.nearest(end, ray.direction)?;
        // The positive direction makes beams to opposite walls comparable.
        let main = surface.normal[surface.normal.iamax()];
        let sign = 1.0_f64.copysign(main);
        let normal = sign * surface.normal;
        let covariance = &self.filter.covariance;
        let of =
            |column: usize| normal.x * covariance[(X, column)] + normal.y * covariance[(Y, column)];
        Some(Wall {
            normal,
            residual: -sign * surface.distance_m,
            deviation: map.deviation_m(),
            covariances: [normal.x * of(X) + normal.y * of(Y), of(HEADING), of(RANGES)],
        })
    }

    /// Returns the fit of a beam to a wall.
    fn fit(&self, wall: &Wall, ray: &Ray, range: f64) -> Fit {
        let Wall {
            normal, residual, ..
        } = *wall;
        let [position, with_heading, with_ranges] = wall.covariances;
        let along = normal.dot(&ray.direction);
        // The component across the normal: how fast the end moves when the robot turns.
        let across = normal.y * ray.direction.x - normal.x * ray.direction.y;
        let covariance = &self.filter.covariance;
        let deviation = self.assumed.range + self.assumed.range_share * range;
        let by_heading = range * across;
        // Without the estimated scale.
        let by_ranges = range / (1.0 + self.filter.ranges) * along;
        let turned_and_scaled = square(by_heading) * covariance[(HEADING, HEADING)]
            + square(by_ranges) * covariance[(RANGES, RANGES)];
        let state_variance = position
            + turned_and_scaled
            + 2.0 * by_heading * with_heading
            + 2.0 * by_ranges * with_ranges
            + 2.0 * by_heading * by_ranges * covariance[(HEADING, RANGES)];
        let measurement_variance = square(along * deviation)
            + square(across * range * self.assumed.beam_rad)
            + square(wall.deviation);
        let variance = state_variance + measurement_variance;
        Fit {
            axis: if normal.x >= normal.y { X } else { Y },
            normal,
            is_shallow: along.abs() <= SHALLOW,
            residual,
            distance: residual * residual / variance,
            by_heading,
            by_ranges,
            variance,
            own_variance: turned_and_scaled + measurement_variance,
        }
    }

    /// Returns true if a beam is accepted as ending at a wall. Outliers can end at walls, too. Where the position is uncertain, a single one would make the robot certain of a
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

    /// Moves the state so that the beam ends nearer to the wall.
    pub(super) fn correct(&mut self, fit: &Fit) {
        let covariance = &mut self.filter.covariance;
        let seen = fit.normal.x * covariance.column(X)
            + fit.normal.y * covariance.column(Y)
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
