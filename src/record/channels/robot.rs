//! `/scene/robot`: what the robot looks like; `/tf` moves it.

use std::f64::consts::FRAC_1_SQRT_2;

use foxglove::messages::{
    ArrowPrimitive, CubePrimitive, CylinderPrimitive, Pose, Quaternion, SceneEntity, SceneUpdate,
};

use super::rounded;
use super::scene::{ROBOT, WHEELS, color, cube, entity, place, update, vector};
use crate::record::info::RobotShape;

const BODY: u32 = 0xf58220;
const DOME: u32 = 0x2b303b;
const TYRE: u32 = 0x15181e;
const SPOKE: u32 = 0xe8ecf2;
const NOSE: u32 = 0xffffff;

/// Body and wheels, each locked to its frame.
pub(in crate::record) fn scene(robot: &RobotShape, time_ns: u64) -> SceneUpdate {
    let wheels = WHEELS.map(|frame| wheel(robot, frame, time_ns));
    let mut entities = vec![body(robot, time_ns)];
    entities.extend(wheels);
    update(entities)
}

/// A disc as wide as the robot is, a dome on it, and an arrow that shows ahead.
fn body(robot: &RobotShape, time_ns: u64) -> SceneEntity {
    let mut body = entity("body", ROBOT, time_ns);
    let (r, axle) = (robot.radius_m, robot.wheel_radius_m);
    let deck = 0.4 * axle + 0.25 * r;
    body.cylinders = vec![
        disc(r, 0.4 * axle, 0.25 * r, 0.92, BODY),
        disc(0.38 * r, deck, 0.25 * r, 0.75, DOME),
    ];
    body.arrows = vec![ArrowPrimitive {
        pose: place(0.1 * r, 0.0, deck + 0.3 * r),
        shaft_length: rounded(0.4 * r),
        shaft_diameter: rounded(0.16 * r),
        head_length: rounded(0.45 * r),
        head_diameter: rounded(0.45 * r),
        color: color(NOSE, 1.0),
    }];
    body
}

/// A round slice from height `bottom` upwards, whose top is scaled.
fn disc(radius: f64, bottom: f64, high: f64, top_scale: f64, rgb: u32) -> CylinderPrimitive {
    CylinderPrimitive {
        pose: place(0.0, 0.0, bottom + high / 2.0),
        size: Some(vector(2.0 * radius, 2.0 * radius, high)),
        bottom_scale: 1.0,
        top_scale,
        color: color(rgb, 1.0),
    }
}

/// A tyre whose axle is y, with a spoke that shows how it turns.
fn wheel(robot: &RobotShape, frame: &str, time_ns: u64) -> SceneEntity {
    let mut wheel = entity(frame, frame, time_ns);
    let (radius, wide) = (robot.wheel_radius_m, 0.5 * robot.wheel_radius_m);
    wheel.cylinders = vec![CylinderPrimitive {
        pose: Some(Pose {
            // A quarter turn about x lays the cylinder's axis along y.
            orientation: Some(Quaternion {
                x: rounded(FRAC_1_SQRT_2),
                w: rounded(FRAC_1_SQRT_2),
                ..Quaternion::default()
            }),
            position: Some(vector(0.0, 0.0, 0.0)),
        }),
        size: Some(vector(2.0 * radius, 2.0 * radius, wide)),
        bottom_scale: 1.0,
        top_scale: 1.0,
        color: color(TYRE, 1.0),
    }];
    wheel.cubes = vec![spoke(radius, wide)];
    wheel
}

fn spoke(radius: f64, wide: f64) -> CubePrimitive {
    cube(
        place(0.0, 0.0, 0.0),
        vector(1.7 * radius, 1.15 * wide, 0.35 * radius),
        color(SPOKE, 1.0),
    )
}
