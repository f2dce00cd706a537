//! The estimate in `/scene/percept`: the estimated pose and its uncertainty.

use foxglove::messages::{CylinderPrimitive, Odometry, Quaternion, SceneEntity};
use nalgebra::{Complex, Matrix3, UnitComplex};
use serde::Serialize;

use super::scene::{ESTIMATE, color, cylinder, entity, heading, place, turned, vector};
use super::{odometry, to_parts};
use xcscr_robot::arena::Estimate;

pub(super) const MARKER: u32 = 0x2f9ce0;
/// The ellipse contains the true position in 99 of 100 samples, if the covariance is consistent.
const DEVIATIONS: f64 = 3.03;
/// The ellipse is enlarged by this factor to be visible; the layouts say so.
const ELLIPSE_SCALE: f64 = 10.0;
const FLAT_M: f64 = 0.01;
/// Finer detail than this fraction is not visible in the picture.
const VISIBLE: f64 = 128.0;
/// Numbers of an ellipse have five decimals, for legibility.
const SHORT: f64 = 100_000.0;
/// The estimated-pose marker is wider than the robot by this factor, so that its rim is visible all
/// around a robot without an error. The ellipse is drawn above the robot, at [`ABOVE`] times the
/// robot's radius.
const RIM: f64 = 1.2;
const ABOVE: f64 = 1.1;

/// The ellipse of one standard deviation around an estimated position.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Ellipse {
    /// Half of the long axis, in metres.
    pub long_m: f64,
    /// Half of the short axis, in metres.
    pub short_m: f64,
    /// The direction of the long axis in the map frame, in radians.
    pub direction_rad: f64,
}

impl Ellipse {
    /// Returns the ellipse of the covariance of a message; a point if the message has none.
    pub fn of(message: &Odometry) -> Self {
        let Some(covariance) = odometry::covariance(message) else {
            return Self::default();
        };
        let (long_m, short_m, direction) = axes(&covariance);
        Self {
            long_m: to_parts(long_m, SHORT),
            short_m: to_parts(short_m, SHORT),
            direction_rad: to_parts(libm::atan2(direction.im, direction.re), SHORT),
        }
    }
}

/// Creates an ellipse around the estimated position, ten times enlarged, and a marker of the
/// estimated pose.
pub(crate) fn entities(estimate: &Estimate, radius_m: f64, time_ns: u64) -> [SceneEntity; 2] {
    let mut ellipse = entity("ellipse", ESTIMATE, time_ns);
    ellipse.cylinders = vec![around(estimate, radius_m)];
    let mut estimated_pose = entity("estimated_pose", ESTIMATE, time_ns);
    let size = vector(2.0 * RIM * radius_m, 2.0 * RIM * radius_m, FLAT_M);
    estimated_pose.cylinders = vec![cylinder(
        place(0.0, 0.0, FLAT_M),
        size,
        1.0,
        color(MARKER, 0.6),
    )];
    [ellipse, estimated_pose]
}

/// Creates the ellipse of an estimate, in the frame of the estimated pose.
fn around(estimate: &Estimate, radius_m: f64) -> CylinderPrimitive {
    let ahead = estimate.robot_in_map.rotation;
    let (long, short, direction) = axes(&estimate.covariance);
    let along = heading(ahead.inverse() * direction);
    let along = Quaternion {
        z: to_parts(along.z, VISIBLE),
        w: to_parts(along.w, VISIBLE),
        ..along
    };
    let drawn = |deviation| to_parts(2.0 * DEVIATIONS * ELLIPSE_SCALE * deviation, VISIBLE);
    let [long, short] = [long, short].map(drawn);
    cylinder(
        turned([0.0, 0.0, ABOVE * radius_m], along),
        vector(long, short, FLAT_M),
        1.0,
        color(MARKER, 0.9),
    )
}

/// Returns the standard deviations along the long and the short axis of the position's ellipse, and
/// the direction of the long axis. They follow from the eigenvalues of a 2x2 matrix, without
/// trigonometry.
fn axes(covariance: &Matrix3<f64>) -> (f64, f64, UnitComplex<f64>) {
    let (xx, yy, xy) = (covariance[(0, 0)], covariance[(1, 1)], covariance[(0, 1)]);
    let (middle, half) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
    let apart = (half * half + xy * xy).sqrt();
    // Of the two forms of the eigenvector, use the one without cancellation.
    let long = if half >= 0.0 {
        Complex::new(half + apart, xy)
    } else {
        Complex::new(xy, apart - half)
    };
    let direction = if apart > 0.0 {
        UnitComplex::new_normalize(long)
    } else {
        UnitComplex::identity()
    };
    let deviation = |variance: f64| variance.max(0.0).sqrt();
    (
        deviation(middle + apart),
        deviation(middle - apart),
        direction,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Isometry2;

    #[test]
    fn axes_recovers_the_axes_of_an_ellipse() {
        for (degrees, long, short) in [
            (0.0_f64, 0.3, 0.1),
            (30.0, 0.2, 0.05),
            (90.0, 0.3, 0.1),
            (150.0, 0.4, 0.2),
        ] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let turn = Matrix3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
            let variances = Matrix3::from_diagonal(&[long * long, short * short, 1.0].into());
            let (found_long, found_short, direction) = axes(&(turn * variances * turn.transpose()));
            assert!((found_long - long).abs() < 1e-9 && (found_short - short).abs() < 1e-9);
            let across = direction.im * cosine - direction.re * sine;
            assert!(across.abs() < 1e-9, "{degrees}: {direction}");
        }
    }

    #[test]
    fn the_ellipse_of_a_message_is_turned_as_its_covariance() {
        // Axes of 0.2 m and 0.1 m, turned by 30 degrees.
        let (xx, yy, xy) = (0.032_5, 0.017_5, 0.015 * 0.75_f64.sqrt());
        let estimate = Estimate {
            covariance: Matrix3::new(xx, xy, 0.0, xy, yy, 0.0, 0.0, 0.0, 1.0),
            robot_in_map: Isometry2::identity(),
        };
        let Ellipse {
            long_m,
            short_m,
            direction_rad,
        } = Ellipse::of(&odometry::estimate(0, &estimate));
        assert!((long_m - 0.2).abs() < 1e-4 && (short_m - 0.1).abs() < 1e-4);
        assert!(
            (direction_rad.to_degrees() - 30.0).abs() < 0.01,
            "{direction_rad}"
        );
        assert_eq!(Ellipse::of(&Odometry::default()), Ellipse::default());
    }

    #[test]
    fn a_circle_has_axes_too() {
        let (long, short, _) = axes(&(0.04 * Matrix3::identity()));
        assert_eq!((long, short), (0.2, 0.2));
    }
}
