//! `/tf` and `/tf_static`: the frames, as in ROS 2 (REP 105).
//!
//! ```text
//! map ─┬─▶ odom ─▶ base_link     where the robot estimates that it is
//!      ├─▶ base_link_true        where it is
//!      └─▶ grid                  the frame of walls and cells, once
//! ```
//!
//! A robot that is given its true pose has `base_link` there. Turning wheels are omitted: they
//! would double the size of a recording and are only a few pixels wide.

use foxglove::messages::{FrameTransform, FrameTransforms, Pose, Quaternion, Vector3};
use nalgebra::Isometry2;

use super::scene::{ESTIMATE, GRID, MAP, ODOM, ROBOT, heading, timestamp};
use super::to_parts;
use crate::event;
use xcscr_robot::world::Maze;

/// Finer detail than this fraction, a millimetre or a tenth of a degree, is not visible in a viewer.
/// Most of a recording is poses.
const VISIBLE: f64 = 1024.0;
/// The correction of dead reckoning is written finer: an error of its angle moves the robot by its
/// distance from the start.
const FINE: f64 = 4096.0;

/// Returns the frames that move, at the time of a pose.
pub(crate) fn moving(pose: &event::Pose) -> FrameTransforms {
    let odom_in_map = pose.assumed_in_map() * pose.robot_in_odom.inverse();
    let frames = [
        (MAP, ODOM, odom_in_map, FINE),
        (ODOM, ESTIMATE, pose.robot_in_odom, VISIBLE),
        (MAP, ROBOT, pose.robot_in_map, VISIBLE),
    ];
    let transforms = frames.map(|(parent, child, at, parts)| {
        frame(
            parent,
            child,
            pose.time_ns,
            position(&at, parts),
            turn(&at, parts),
        )
    });
    FrameTransforms {
        transforms: transforms.into(),
    }
}

/// Returns the frame of the grid. It is not rounded because a whole map is drawn in it.
pub(crate) fn fixed(maze: &Maze, time_ns: u64) -> FrameTransforms {
    let origin = maze.origin();
    let (sine, cosine) = libm::sincos(origin.yaw_rad / 2.0);
    let at = Vector3 {
        x: origin.x_m,
        y: origin.y_m,
        z: 0.0,
    };
    let turned = Quaternion {
        z: sine,
        w: cosine,
        ..Quaternion::default()
    };
    FrameTransforms {
        transforms: vec![frame(MAP, GRID, time_ns, at, turned)],
    }
}

fn frame(
    parent: &str,
    child: &str,
    time_ns: u64,
    at: Vector3,
    turned: Quaternion,
) -> FrameTransform {
    FrameTransform {
        timestamp: Some(timestamp(time_ns)),
        parent_frame_id: parent.to_owned(),
        child_frame_id: child.to_owned(),
        translation: Some(at),
        rotation: Some(turned),
    }
}

/// Returns the position of a pose on the floor, in multiples of 1 / `parts`.
fn position(pose: &Isometry2<f64>, parts: f64) -> Vector3 {
    let [x, y] = [pose.translation.x, pose.translation.y].map(|along| to_parts(along, parts));
    Vector3 { x, y, z: 0.0 }
}

/// Returns the heading of a pose on the floor, in multiples of 1 / `parts`.
fn turn(pose: &Isometry2<f64>, parts: f64) -> Quaternion {
    let turned = heading(pose.rotation);
    Quaternion {
        z: to_parts(turned.z, parts),
        w: to_parts(turned.w, parts),
        ..turned
    }
}

/// Returns position and heading of a pose on the floor, as fine as is visible.
pub(super) fn visible(pose: &Isometry2<f64>) -> Pose {
    Pose {
        position: Some(position(pose, VISIBLE)),
        orientation: Some(turn(pose, VISIBLE)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector2};
    use xcscr_robot::arena::Estimate;

    /// Returns parent, child and position of each frame.
    fn shown(message: &FrameTransforms) -> Vec<(&str, &str, [f64; 2])> {
        let frame = |frame: &'_ FrameTransform| {
            let at = frame.translation.as_ref().unwrap();
            [at.x, at.y]
        };
        let all = message.transforms.iter();
        all.map(|one| (&*one.parent_frame_id, &*one.child_frame_id, frame(one)))
            .collect()
    }

    #[test]
    fn frames_have_the_same_names_in_every_world() {
        for (origin, at) in [("", [0.0, 0.0]), (r#""origin": [7, 2, 0.25],"#, [7.0, 2.0])] {
            let text = format!(r######"{{ {origin} "rows": ["####", "#SG#", "####"] }}"######);
            let maze = Maze::from_json(text.as_bytes(), "m.json").unwrap();
            assert_eq!(shown(&fixed(&maze, 0)), [("map", "grid", at)]);
        }
    }

    #[test]
    fn base_link_is_at_the_estimate_and_odom_corrects_dead_reckoning() {
        let at = |x, y| Isometry2::new(Vector2::new(x, y), 0.0);
        let mut pose = event::Pose {
            time_ns: 0,
            robot_in_map: at(8.5, 2.5),
            robot_in_odom: at(1.0, 0.0),
            estimate: Some(Estimate {
                robot_in_map: at(8.0, 2.0),
                covariance: Matrix3::identity(),
            }),
            velocity_mps: Vector2::zeros(),
            turn_radps: 0.0,
        };
        let reckoned = ("odom", "base_link", [1.0, 0.0]);
        let truth = ("map", "base_link_true", [8.5, 2.5]);
        let frames = [("map", "odom", [7.0, 2.0]), reckoned, truth];
        assert_eq!(shown(&moving(&pose)), frames);
        pose.estimate = None;
        let frames = [("map", "odom", [7.5, 2.5]), reckoned, truth];
        assert_eq!(shown(&moving(&pose)), frames);
    }
}
