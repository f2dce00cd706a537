//! `/tf`: where the robot is.
//!
//! Every message carries the whole tree of frames, which is one frame, and where a robot that
//! senses believes to be as another one: wheels that turn would
//! double the size of a recording for something a few pixels wide. It also carries the next poses,
//! each with its time: viewers draw the robot between them, so that it glides, and a message for
//! each pose would cost a third of the file in headers and index alone.

use foxglove::messages::{FrameTransform, FrameTransforms};
use nalgebra::Isometry2;

use super::scene::{ESTIMATE, ROBOT, WORLD, heading, timestamp, vector};
use crate::arena::{Estimate, Sample};

/// The message, kept from stretch to stretch so that nothing is allocated.
#[derive(Debug, Default)]
pub(in crate::record) struct Transforms {
    message: FrameTransforms,
}

impl Transforms {
    /// The frames as they were at the moments of some samples, oldest first.
    ///
    /// Where a robot that senses believes to be is shown for the first moment only: it differs by
    /// so little that a viewer sees no step, and all of them would double the message.
    pub fn along(&mut self, stretch: &[Sample], belief: Option<&Estimate>) -> &FrameTransforms {
        let transforms = &mut self.message.transforms;
        transforms.truncate(stretch.len());
        transforms.resize_with(stretch.len(), robot_frame);
        for (frame, sample) in transforms.iter_mut().zip(stretch) {
            ROBOT.clone_into(&mut frame.child_frame_id);
            put(frame, sample.time_ns, &sample.robot_in_world);
        }
        if let Some((estimate, first)) = belief.zip(stretch.first()) {
            let mut frame = robot_frame();
            ESTIMATE.clone_into(&mut frame.child_frame_id);
            put(&mut frame, first.time_ns, &estimate.robot_in_world);
            transforms.push(frame);
        }
        &self.message
    }
}

/// Puts a frame to a pose at a time.
fn put(frame: &mut FrameTransform, time_ns: u64, pose: &Isometry2<f64>) {
    let middle = pose.translation;
    frame.timestamp = Some(timestamp(time_ns));
    frame.translation = Some(vector(middle.x, middle.y, 0.0));
    frame.rotation = Some(heading(pose.rotation));
}

fn robot_frame() -> FrameTransform {
    FrameTransform {
        parent_frame_id: WORLD.to_owned(),
        child_frame_id: ROBOT.to_owned(),
        ..FrameTransform::default()
    }
}
