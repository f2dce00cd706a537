//! `/scene/robot`: the robot's body; `/tf` moves it.

use std::f64::consts::FRAC_1_SQRT_2;

use foxglove::messages::{CylinderPrimitive, Quaternion, SceneEntity, SceneUpdate};

use super::rounded;
use super::scene::{ROBOT, color, cylinder, entity, place, turned, update, vector};
use crate::info::RobotShape;

const BODY: u32 = 0xf58220;
const DOME: u32 = 0x2b303b;
const TYRE: u32 = 0x15181e;
const NOSE: u32 = 0xffffff;

/// Creates a disc as wide as the robot, two wheels, a dome and an arrow that points ahead.
pub(crate) fn scene(robot: &RobotShape, time_ns: u64) -> SceneUpdate {
    let (r, axle) = (robot.radius_m, robot.wheel_radius_m());
    let deck = 0.4 * axle + 0.25 * r;
    let mut body: SceneEntity = entity("body", ROBOT, time_ns);
    body.cylinders = vec![
        disc(r, 0.4 * axle, 0.25 * r, 0.92, BODY),
        disc(0.38 * r, deck, 0.25 * r, 0.75, DOME),
        wheel(robot, 0.5),
        wheel(robot, -0.5),
    ];
    let high = deck + 0.3 * r;
    body.cylinders.extend([
        ahead([0.1 * r, 0.5 * r], high, [0.16 * r, 0.16 * r]),
        ahead([0.5 * r, 0.95 * r], high, [0.45 * r, 0.0]),
    ]);
    update(vec![body])
}

/// Creates a part of the arrow that points ahead: its ends, its height, and its width at both ends.
fn ahead([from, to]: [f64; 2], high: f64, [wide, narrow]: [f64; 2]) -> CylinderPrimitive {
    // A quarter turn about y lays the cylinder's axis along x.
    let quarter = rounded(FRAC_1_SQRT_2);
    let along_x = Quaternion {
        y: quarter,
        w: quarter,
        ..Quaternion::default()
    };
    cylinder(
        turned([(from + to) / 2.0, 0.0, high], along_x),
        vector(wide, wide, to - from),
        narrow / wide,
        color(NOSE, 1.0),
    )
}

/// Creates a round slice from height `bottom` upwards, with a scaled top.
fn disc(radius: f64, bottom: f64, high: f64, top_scale: f64, rgb: u32) -> CylinderPrimitive {
    cylinder(
        place(0.0, 0.0, bottom + high / 2.0),
        vector(2.0 * radius, 2.0 * radius, high),
        top_scale,
        color(rgb, 1.0),
    )
}

/// Creates a wheel on the left or the right; `side` is a share of the wheel base.
fn wheel(robot: &RobotShape, side: f64) -> CylinderPrimitive {
    let radius = robot.wheel_radius_m();
    // A quarter turn about x lays the cylinder's axis along y.
    let quarter = rounded(FRAC_1_SQRT_2);
    let along_y = Quaternion {
        x: quarter,
        w: quarter,
        ..Quaternion::default()
    };
    cylinder(
        turned([0.0, side * robot.wheel_base_m, radius], along_y),
        vector(2.0 * radius, 2.0 * radius, 0.6 * radius),
        1.0,
        color(TYRE, 1.0),
    )
}
