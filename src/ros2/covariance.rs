//! The covariances of simulated dead reckoning.

use nalgebra::{Isometry2, Matrix2, Matrix3, Matrix3x2};
use xcscr_sensing::STEP_S;

use crate::arena::PhysicsParams;
use crate::drive::Odometry;
use crate::drive::messages::{Covariance, on_floor};

/// The covariance of the pose, which grows with the way. The errors of the wheels count as independent
/// from step to step, so it is a lower bound.
#[derive(Debug, Default)]
pub struct DeadReckoning {
    of_pose: Matrix3<f64>,
    last: Isometry2<f64>,
}

impl DeadReckoning {
    /// Takes in the odometry of a step. Returns the covariances of its pose and of its speeds.
    pub fn add(&mut self, odometry: &Odometry, physics: &PhysicsParams) -> [Covariance; 2] {
        let PhysicsParams {
            noise,
            wheel_bias,
            wheel_noise,
            wheel_base_m,
            ..
        } = *physics;
        let half_mps = odometry.speeds.turn_radps * wheel_base_m / 2.0;
        let rims_mps = [-half_mps, half_mps].map(|turn| odometry.speeds.forward_mps + turn);
        let [left, right] =
            rims_mps.map(|rim| (noise * wheel_bias.hypot(wheel_noise) * rim).powi(2));
        let both = (right - left) / (2.0 * wheel_base_m);
        let of_speeds = Matrix2::new(
            (left + right) / 4.0,
            both,
            both,
            (left + right) / (wheel_base_m * wheel_base_m),
        );
        let moved = odometry.pose.translation.vector - self.last.translation.vector;
        let heading = self.last.rotation;
        let by_pose = Matrix3::new(1.0, 0.0, -moved.y, 0.0, 1.0, moved.x, 0.0, 0.0, 1.0);
        let by_speeds = STEP_S * Matrix3x2::new(heading.re, 0.0, heading.im, 0.0, 0.0, 1.0);
        self.of_pose = by_pose * self.of_pose * by_pose.transpose()
            + by_speeds * of_speeds * by_speeds.transpose();
        self.last = odometry.pose;
        let mut of_twist = Matrix3::zeros();
        for (row, own) in [(0, 0), (2, 1)] {
            for (column, other) in [(0, 0), (2, 1)] {
                of_twist[(row, column)] = of_speeds[(own, other)];
            }
        }
        [on_floor(&self.of_pose), on_floor(&of_twist)]
    }
}
