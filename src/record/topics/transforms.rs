//! `/tf`: where the robot is.
//!
//! Every message carries the whole tree of frames, which is one frame: wheels that turn would
//! double the size of a recording for something a few pixels wide. It also carries the next poses,
//! each with its time: viewers draw the robot between them, so that it glides, and a message for
//! each pose would cost a third of the file in headers and index alone.

use foxglove::messages::{FrameTransform, FrameTransforms};

use super::scene::{ROBOT, WORLD, heading, timestamp, vector};
use crate::arena::Sample;

/// The message, kept from stretch to stretch so that nothing is allocated.
#[derive(Debug, Default)]
pub(in crate::record) struct Transforms {
    message: FrameTransforms,
}

impl Transforms {
    /// The frames as they were at the moments of some samples, oldest first.
    pub fn along(&mut self, stretch: &[Sample]) -> &FrameTransforms {
        let transforms = &mut self.message.transforms;
        transforms.resize_with(stretch.len(), robot_frame);
        for (frame, sample) in transforms.iter_mut().zip(stretch) {
            let robot = sample.robot_in_world;
            let middle = robot.translation;
            frame.timestamp = Some(timestamp(sample.time_ns));
            frame.translation = Some(vector(middle.x, middle.y, 0.0));
            frame.rotation = Some(heading(robot.rotation));
        }
        &self.message
    }
}

fn robot_frame() -> FrameTransform {
    FrameTransform {
        parent_frame_id: WORLD.to_owned(),
        child_frame_id: ROBOT.to_owned(),
        ..FrameTransform::default()
    }
}
