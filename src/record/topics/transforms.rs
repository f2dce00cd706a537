//! `/tf`: the robot's pose.
//!
//! Every message carries the whole tree of frames: the robot in the map frame, and below the robot
//! the error of a robot that estimates its pose. In worlds with an `origin`, the grid frame, in
//! which walls are drawn, is a separate frame in the map frame. In other worlds the two are the
//! same. Turning wheels are omitted: they would double the size of a recording and are only a few
//! pixels wide.
//!
//! A message also carries the poses of the next two seconds, each with its time. Viewers
//! interpolate between them, so that the robot moves smoothly. A message per pose would add a third
//! of the file in headers and index.

use foxglove::messages::{FrameTransform, FrameTransforms, Quaternion, Vector3};
use nalgebra::Isometry2;

use super::scene::{ESTIMATE, MAP, ROBOT, WORLD, heading, timestamp};
use super::to_parts;
use crate::arena::{Estimate, Sample};
use crate::world::{Maze, Origin};

/// Finer detail than this fraction, a millimetre or a tenth of a degree, is not visible in a viewer.
/// Most of a recording is poses.
const VISIBLE: f64 = 1024.0;

/// The message, reused between segments to avoid allocations.
#[derive(Debug, Default)]
pub(in crate::record) struct Transforms {
    message: FrameTransforms,
    /// The pose of the grid frame in the map frame, in worlds where they differ.
    origin: Option<Origin>,
}

impl Transforms {
    /// Creates the frames of a robot in this maze.
    pub fn new(maze: &Maze) -> Self {
        Self {
            origin: (maze.origin() != Origin::default()).then(|| maze.origin()),
            ..Self::default()
        }
    }

    /// Returns the frames at the times of some samples, oldest first.
    ///
    /// The estimated pose relative to the true pose is given for the first sample only. It changes
    /// slowly, and all of them would double the message.
    pub fn along(&mut self, segment: &[Sample], belief: Option<&Estimate>) -> &FrameTransforms {
        let root = if self.origin.is_some() { MAP } else { WORLD };
        let transforms = &mut self.message.transforms;
        transforms.truncate(segment.len());
        transforms.resize_with(segment.len(), FrameTransform::default);
        for (frame, sample) in transforms.iter_mut().zip(segment) {
            name(frame, root, ROBOT);
            put(frame, sample.time_ns, &sample.robot_in_map);
        }
        if let Some((estimate, first)) = belief.zip(segment.first()) {
            let mut frame = FrameTransform::default();
            name(&mut frame, ROBOT, ESTIMATE);
            let mistake = first.robot_in_map.inv_mul(&estimate.robot_in_map);
            put(&mut frame, first.time_ns, &mistake);
            transforms.push(frame);
        }
        if let Some((origin, first)) = self.origin.zip(segment.first()) {
            transforms.push(grid_frame(origin, first.time_ns));
        }
        &self.message
    }
}

/// Returns the grid frame in the map frame. It is not rounded because a whole map is drawn in it.
fn grid_frame(origin: Origin, time_ns: u64) -> FrameTransform {
    let (sine, cosine) = libm::sincos(origin.yaw_rad / 2.0);
    FrameTransform {
        timestamp: Some(timestamp(time_ns)),
        parent_frame_id: MAP.to_owned(),
        child_frame_id: WORLD.to_owned(),
        translation: Some(Vector3 {
            x: origin.x_m,
            y: origin.y_m,
            z: 0.0,
        }),
        rotation: Some(Quaternion {
            z: sine,
            w: cosine,
            ..Quaternion::default()
        }),
    }
}

/// Sets a frame's pose and time.
fn put(frame: &mut FrameTransform, time_ns: u64, pose: &Isometry2<f64>) {
    let middle = pose.translation;
    frame.timestamp = Some(timestamp(time_ns));
    frame.translation = Some(Vector3 {
        x: to_parts(middle.x, VISIBLE),
        y: to_parts(middle.y, VISIBLE),
        z: 0.0,
    });
    let turned = heading(pose.rotation);
    frame.rotation = Some(Quaternion {
        z: to_parts(turned.z, VISIBLE),
        w: to_parts(turned.w, VISIBLE),
        ..turned
    });
}

fn name(frame: &mut FrameTransform, parent: &str, child: &str) {
    parent.clone_into(&mut frame.parent_frame_id);
    child.clone_into(&mut frame.child_frame_id);
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    /// Returns the frames of a robot in a world with this key: parent, child and position of each.
    fn frames(origin: &str) -> Vec<(String, String, [f64; 2])> {
        let text = format!(r######"{{ {origin} "rows": ["####", "#SG#", "####"] }}"######);
        let maze = Maze::from_json(text.as_bytes(), "m.json").unwrap();
        let sample = Sample {
            time_ns: 0,
            robot_in_map: Isometry2::new(Vector2::new(8.5, 2.5), 0.25),
            wheel_travel_m: [0.0; 2],
        };
        let mut transforms = Transforms::new(&maze);
        let message = transforms.along(&[sample], None);
        let frame = |frame: &FrameTransform| {
            let at = frame.translation.as_ref().unwrap();
            let (parent, child) = (&frame.parent_frame_id, &frame.child_frame_id);
            (parent.clone(), child.clone(), [at.x, at.y])
        };
        message.transforms.iter().map(frame).collect()
    }

    #[test]
    fn robot_and_grid_are_in_the_map_frame_if_the_world_has_one() {
        let robot = |parent: &str| (parent.to_owned(), ROBOT.to_owned(), [8.5, 2.5]);
        assert_eq!(frames(""), [robot(WORLD)]);
        let grid = (MAP.to_owned(), WORLD.to_owned(), [7.0, 2.0]);
        assert_eq!(frames(r#""origin": [7, 2, 0.25],"#), [robot(MAP), grid]);
    }
}
