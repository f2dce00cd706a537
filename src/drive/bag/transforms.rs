//! Poses and transforms as messages, and their conversion to the driver's readings.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

use super::messages::{
    EstimatedPose, Pose, PoseWithCovariance, Quaternion, TransformStamped, Transforms, UNKNOWN,
    Vector3, header,
};
use crate::drive;

impl Pose {
    /// Returns the pose in space. Its numbers may be invalid, like those of the message. The rotation is
    /// not a number if the orientation is none.
    fn in_space(&self) -> Isometry3<f64> {
        let Quaternion { x, y, z, w } = self.orientation;
        let w = if self.orientation.is_rotation() {
            w
        } else {
            f64::NAN
        };
        let at = self.position;
        Isometry3::from_parts(
            Translation3::new(at.x, at.y, at.z),
            UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z)),
        )
    }
}

impl From<&TransformStamped> for drive::Transform {
    fn from(message: &TransformStamped) -> Self {
        Self {
            parent: message.header.frame_id.to_string(),
            child: message.child_frame_id.to_string(),
            pose: message.transform.in_space(),
        }
    }
}

impl From<&EstimatedPose> for drive::Transform {
    fn from(message: &EstimatedPose) -> Self {
        Self {
            parent: message.header.frame_id.to_string(),
            child: String::new(),
            pose: message.pose.pose.in_space(),
        }
    }
}

impl From<&drive::Transform> for EstimatedPose {
    fn from(pose: &drive::Transform) -> Self {
        Self {
            header: header(0, pose.parent.clone()),
            pose: PoseWithCovariance {
                pose: Pose::from(&pose.pose),
                covariance: UNKNOWN,
            },
        }
    }
}

impl From<&Isometry3<f64>> for Pose {
    fn from(pose: &Isometry3<f64>) -> Self {
        let (at, turn) = (pose.translation, pose.rotation);
        Self {
            position: Vector3 {
                x: at.x,
                y: at.y,
                z: at.z,
            },
            orientation: Quaternion {
                x: turn.i,
                y: turn.j,
                z: turn.k,
                w: turn.w,
            },
        }
    }
}

impl From<&[drive::Transform]> for Transforms {
    fn from(all: &[drive::Transform]) -> Self {
        let message = |transform: &drive::Transform| TransformStamped {
            header: header(0, transform.parent.clone()),
            child_frame_id: transform.child.clone().into(),
            transform: Pose::from(&transform.pose),
        };
        Self {
            transforms: all.iter().map(message).collect(),
        }
    }
}
