//! `/tf`: where the robot is.
//!
//! Every message carries the whole tree of frames, which is one frame, and how far a robot that
//! senses is mistaken as another one below it: wheels that turn would double the size of a
//! recording for something a few pixels wide. It also carries the poses of the next two seconds, each
//! with its time: viewers draw the robot between them, so that it glides, and a message for each
//! pose would cost a third of the file in headers and index alone.

use foxglove::messages::{FrameTransform, FrameTransforms, Quaternion, Vector3};
use nalgebra::Isometry2;

use super::scene::{ESTIMATE, ROBOT, WORLD, heading, timestamp};
use crate::arena::{Estimate, Sample};

/// The message, kept from stretch to stretch so that nothing is allocated.
#[derive(Debug, Default)]
pub(in crate::record) struct Transforms {
    message: FrameTransforms,
}

impl Transforms {
    /// The frames as they were at the moments of some samples, oldest first.
    ///
    /// Where a robot that senses believes to be, seen from where it is, is told for the first
    /// moment only: that changes slowly, and all of them would double the message.
    pub fn along(&mut self, stretch: &[Sample], belief: Option<&Estimate>) -> &FrameTransforms {
        let transforms = &mut self.message.transforms;
        transforms.truncate(stretch.len());
        transforms.resize_with(stretch.len(), FrameTransform::default);
        for (frame, sample) in transforms.iter_mut().zip(stretch) {
            name(frame, WORLD, ROBOT);
            put(frame, sample.time_ns, &sample.robot_in_world);
        }
        if let Some((estimate, first)) = belief.zip(stretch.first()) {
            let mut frame = FrameTransform::default();
            name(&mut frame, ROBOT, ESTIMATE);
            let mistake = first.robot_in_world.inv_mul(&estimate.robot_in_world);
            put(&mut frame, first.time_ns, &mistake);
            transforms.push(frame);
        }
        &self.message
    }
}

/// Puts a frame to a pose at a time.
fn put(frame: &mut FrameTransform, time_ns: u64, pose: &Isometry2<f64>) {
    let middle = pose.translation;
    frame.timestamp = Some(timestamp(time_ns));
    frame.translation = Some(Vector3 {
        x: seen(middle.x),
        y: seen(middle.y),
        z: 0.0,
    });
    let turned = heading(pose.rotation);
    frame.rotation = Some(Quaternion {
        z: seen(turned.z),
        w: seen(turned.w),
        ..turned
    });
}

/// A number as finely as anyone sees it in a viewer, a millimetre or a tenth of a degree: most of
/// what a recording holds is poses.
fn seen(number: f64) -> f64 {
    (number * 1024.0).round() / 1024.0 + 0.0
}

fn name(frame: &mut FrameTransform, parent: &str, child: &str) {
    parent.clone_into(&mut frame.parent_frame_id);
    child.clone_into(&mut frame.child_frame_id);
}
