//! `/tf`: where the robot is.
//!
//! Every message carries the whole tree of frames, which is one frame: wheels that turn would
//! double the size of a recording for something a few pixels wide.

use foxglove::messages::{FrameTransform, FrameTransforms};

use super::scene::{ROBOT, WORLD, heading, timestamp, vector};
use crate::arena::Sample;

/// The message, kept from sample to sample so that nothing is allocated.
#[derive(Debug)]
pub(in crate::record) struct Transforms {
    message: FrameTransforms,
}

impl Transforms {
    pub fn new() -> Self {
        let robot = FrameTransform {
            parent_frame_id: WORLD.to_owned(),
            child_frame_id: ROBOT.to_owned(),
            ..FrameTransform::default()
        };
        let transforms = vec![robot];
        Self {
            message: FrameTransforms { transforms },
        }
    }

    /// The frames as they were at the moment of a sample.
    pub fn at(&mut self, sample: &Sample) -> &FrameTransforms {
        let robot = sample.robot_in_world;
        let middle = robot.translation;
        for frame in &mut self.message.transforms {
            frame.timestamp = Some(timestamp(sample.time_ns));
            frame.translation = Some(vector(middle.x, middle.y, 0.0));
            frame.rotation = Some(heading(robot.rotation));
        }
        &self.message
    }
}
