//! `/tf`: the whole tree of frames in one message.

use foxglove::messages::{FrameTransform, FrameTransforms, Quaternion};
use nalgebra::ComplexField;

use super::rounded;
use super::scene::{ROBOT, WHEELS, WORLD, heading, timestamp, vector};
use crate::arena::Sample;
use crate::record::info::RobotShape;

/// The message, kept from sample to sample so that nothing is allocated.
#[derive(Debug)]
pub(in crate::record) struct Transforms {
    message: FrameTransforms,
    wheel_radius_m: f64,
}

impl Transforms {
    pub fn new(robot: &RobotShape) -> Self {
        let frame = |parent: &str, child: &str, y: f64, z: f64| FrameTransform {
            timestamp: None,
            parent_frame_id: parent.to_owned(),
            child_frame_id: child.to_owned(),
            translation: Some(vector(0.0, y, z)),
            rotation: None,
        };
        let hub = (robot.wheel_base_m / 2.0, robot.wheel_radius_m);
        let transforms = vec![
            frame(WORLD, ROBOT, 0.0, 0.0),
            frame(ROBOT, WHEELS[0], hub.0, hub.1),
            frame(ROBOT, WHEELS[1], -hub.0, hub.1),
        ];
        Self {
            message: FrameTransforms { transforms },
            wheel_radius_m: robot.wheel_radius_m,
        }
    }

    /// The frames as they were at the moment of a sample.
    pub fn at(&mut self, sample: &Sample) -> &FrameTransforms {
        let time = Some(timestamp(sample.time_ns));
        let [left, right] = sample
            .wheel_travel_m
            .map(|way| rolled(way / self.wheel_radius_m));
        let robot = sample.robot_in_world;
        let turned = [heading(robot.rotation), left, right];
        for (frame, rotation) in self.message.transforms.iter_mut().zip(turned) {
            frame.timestamp = time;
            frame.rotation = Some(rotation);
        }
        let middle = robot.translation;
        self.message.transforms[0].translation = Some(vector(middle.x, middle.y, 0.0));
        &self.message
    }
}

/// A rotation about y. The sine is nalgebra's, which is the same on every machine.
fn rolled(angle_rad: f64) -> Quaternion {
    let (sin, cos) = ComplexField::sin_cos(angle_rad / 2.0);
    Quaternion {
        x: 0.0,
        y: rounded(sin),
        z: 0.0,
        w: rounded(cos),
    }
}
