//! `/ground_truth` and `/estimate`: the true pose with its speeds, and the estimated pose with its
//! covariance, as numbers to plot.

use foxglove::messages::{Odometry, Vector3};

use super::scene::{ESTIMATE, MAP, ROBOT, timestamp};
use super::transforms::visible;
use super::{rounded, to_parts};
use crate::event::Pose;
use nalgebra::{Isometry2, Matrix3};
use xcscr_robot::arena::Estimate;

/// Covariances are written in multiples of this fraction of a square metre: a millimetre, squared.
const PARTS: f64 = 1_048_576.0;
/// The place of x, y and heading in a covariance of six dimensions.
const INDICES: [usize; 3] = [0, 1, 5];

/// Returns the true pose and the true speeds. The covariance is empty: there is no error.
pub(crate) fn truth(pose: &Pose) -> Odometry {
    let [x, y] = [pose.velocity_mps.x, pose.velocity_mps.y].map(rounded);
    Odometry {
        linear_velocity: Some(Vector3 { x, y, z: 0.0 }),
        angular_velocity: Some(Vector3 {
            x: 0.0,
            y: 0.0,
            z: rounded(pose.turn_radps),
        }),
        ..message(pose.time_ns, ROBOT, &pose.robot_in_map)
    }
}

/// Returns the estimated pose and its covariance.
pub(crate) fn estimate(time_ns: u64, estimate: &Estimate) -> Odometry {
    let mut covariance = vec![0.0; 36];
    for (row, &index) in INDICES.iter().enumerate() {
        for (column, &other) in INDICES.iter().enumerate() {
            covariance[6 * index + other] = to_parts(estimate.covariance[(row, column)], PARTS);
        }
    }
    Odometry {
        pose_covariance: covariance,
        ..message(time_ns, ESTIMATE, &estimate.robot_in_map)
    }
}

/// Returns the covariance of x, y and heading; `None` if the message has none.
pub(super) fn covariance(message: &Odometry) -> Option<Matrix3<f64>> {
    let all = &message.pose_covariance;
    let entry = |row: usize, column: usize| all[6 * INDICES[row] + INDICES[column]];
    (all.len() == 36).then(|| Matrix3::from_fn(entry))
}

fn message(time_ns: u64, body: &str, at: &Isometry2<f64>) -> Odometry {
    Odometry {
        timestamp: Some(timestamp(time_ns)),
        frame_id: MAP.to_owned(),
        body_frame_id: body.to_owned(),
        pose: Some(visible(at)),
        ..Odometry::default()
    }
}
