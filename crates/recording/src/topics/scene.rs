//! Building blocks of 3D scenes.

use foxglove::messages::{
    Color, CubePrimitive, CylinderPrimitive, LinePrimitive, Point3, Pose, Quaternion, SceneEntity,
    SceneUpdate, TextPrimitive, Timestamp, TriangleListPrimitive, Vector3, line_primitive,
};
use nalgebra::{Point2, UnitComplex, Vector2};

use super::rounded;
use crate::EPOCH_NS;
use xcscr_robot::world::Maze;

/// The grid frame, in which all static objects are drawn: origin in the south-western corner, x
/// east, y north, z up.
pub(crate) const GRID: &str = "grid";
/// The map frame.
pub(super) const MAP: &str = "map";
/// The frame of dead reckoning.
pub(super) const ODOM: &str = "odom";
/// The robot's frame at its true pose: origin on the floor below its middle, x ahead, y to the left.
pub(super) const ROBOT: &str = "base_link_true";
/// The robot's frame at its estimated pose.
pub(super) const ESTIMATE: &str = "base_link";

/// Returns the width and the height of a maze, in metres.
pub(crate) fn size_m(maze: &Maze) -> [f64; 2] {
    [maze.width(), maze.height()].map(|cells| f64::from(cells) * maze.cell_size_m())
}

/// Converts a time of the simulation clock to a time of day.
pub(crate) fn timestamp(time_ns: u64) -> Timestamp {
    const SECOND: u64 = 1_000_000_000;
    let time_ns = EPOCH_NS.saturating_add(time_ns);
    let sec = u32::try_from(time_ns / SECOND).unwrap_or(u32::MAX);
    Timestamp::new(sec, (time_ns % SECOND) as u32)
}

/// Returns the colour `0xRRGGBB` with an opacity from 0 to 1.
pub(super) fn color(rgb: u32, opacity: f64) -> Color {
    let part = |shift: u32| rounded(f64::from(rgb >> shift & 0xff) / 255.0);
    Color {
        r: part(16),
        g: part(8),
        b: part(0),
        a: rounded(opacity),
    }
}

/// Returns the opaque colour at a share, from 0 to 1, of the way between two colours.
pub(super) fn mixed(from: Color, to: Color, share: f64) -> Color {
    let mix = |from: f64, to: f64| rounded(from + (to - from) * share);
    Color {
        r: mix(from.r, to.r),
        g: mix(from.g, to.g),
        b: mix(from.b, to.b),
        a: 1.0,
    }
}

pub(super) fn vector(x: f64, y: f64, z: f64) -> Vector3 {
    Vector3 {
        x: rounded(x),
        y: rounded(y),
        z: rounded(z),
    }
}

pub(super) fn point(at: Point2<f64>, z: f64) -> Point3 {
    Point3 {
        x: rounded(at.x),
        y: rounded(at.y),
        z: rounded(z),
    }
}

/// Returns the rotation about z by the angle of `heading`, without trigonometry.
pub(super) fn heading(heading: UnitComplex<f64>) -> Quaternion {
    let half = |cos: f64| ((1.0 + cos) / 2.0).max(0.0).sqrt();
    Quaternion {
        x: 0.0,
        y: 0.0,
        z: half(-heading.re).copysign(heading.im),
        w: half(heading.re),
    }
}

/// Returns a pose at a position, with the axes of the frame.
pub(super) fn place(x: f64, y: f64, z: f64) -> Pose {
    let unturned = Quaternion {
        w: 1.0,
        ..Quaternion::default()
    };
    turned([x, y, z], unturned)
}

/// Returns a pose at a position with this rotation.
pub(super) fn turned([x, y, z]: [f64; 3], rotation: Quaternion) -> Pose {
    Pose {
        position: Some(vector(x, y, z)),
        orientation: Some(rotation),
    }
}

pub(super) fn cube(pose: Pose, size: Vector3, color: Color) -> CubePrimitive {
    CubePrimitive {
        pose: Some(pose),
        size: Some(size),
        color: Some(color),
    }
}

/// Creates a cylinder, whose axis is the z axis of its pose. The top is scaled by `top`.
pub(super) fn cylinder(pose: Pose, size: Vector3, top: f64, color: Color) -> CylinderPrimitive {
    CylinderPrimitive {
        pose: Some(pose),
        size: Some(size),
        bottom_scale: 1.0,
        top_scale: rounded(top),
        color: Some(color),
    }
}

/// Creates lines between pairs of points, with a thickness in metres.
pub(super) fn lines(
    pose: Pose,
    thickness: f64,
    points: Vec<Point3>,
    color: Color,
) -> LinePrimitive {
    LinePrimitive {
        r#type: line_primitive::Type::LineList as i32,
        pose: Some(pose),
        thickness: rounded(thickness),
        points,
        color: Some(color),
        ..LinePrimitive::default()
    }
}

/// Creates quadrilaterals of two triangles each, from four corners each.
pub(super) fn quads(pose: Pose, corners: Vec<Point3>, color: Color) -> TriangleListPrimitive {
    TriangleListPrimitive {
        pose: Some(pose),
        indices: indices_by_four(&corners, [0, 1, 2, 0, 2, 3]),
        points: corners,
        color: Some(color),
        colors: Vec::new(),
    }
}

/// Returns the corners of a square with this distance from its middle to its sides.
pub(super) fn square(middle: Point2<f64>, half: f64) -> [Point3; 4] {
    [[-half, -half], [half, -half], [half, half], [-half, half]]
        .map(|[x, y]| point(middle + Vector2::new(x, y), 0.0))
}

/// Returns indices into points, from the indices within each four points.
pub(super) fn indices_by_four<const N: usize>(points: &[Point3], each: [u32; N]) -> Vec<u32> {
    let fours = 0..points.len() as u32 / 4;
    let indices = fours.flat_map(|four| each.map(|corner| 4 * four + corner));
    indices.collect()
}

/// Creates text that lies on the floor and reads from the south.
pub(super) fn words(pose: Pose, height: f64, rgb: u32, text: &str) -> TextPrimitive {
    TextPrimitive {
        pose: Some(pose),
        billboard: false,
        font_size: rounded(height),
        scale_invariant: false,
        color: Some(color(rgb, 1.0)),
        text: text.to_owned(),
    }
}

/// Creates text that faces the camera.
pub(super) fn label(pose: Pose, height: f64, rgb: u32, text: &str) -> TextPrimitive {
    TextPrimitive {
        billboard: true,
        ..words(pose, height, rgb, text)
    }
}

/// Creates an empty entity.
pub(super) fn entity(id: &str, frame: &str, time_ns: u64) -> SceneEntity {
    SceneEntity {
        timestamp: Some(timestamp(time_ns)),
        frame_id: frame.to_owned(),
        id: id.to_owned(),
        frame_locked: frame != GRID,
        ..SceneEntity::default()
    }
}

/// Creates a message that replaces all entities of its topic.
pub(super) fn update(entities: Vec<SceneEntity>) -> SceneUpdate {
    SceneUpdate {
        deletions: Vec::new(),
        entities,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_turns_about_z_the_short_way() {
        for degrees in [-180_i32, -135, -90, -1, 0, 45, 90, 179] {
            let angle = f64::from(degrees).to_radians();
            let turned = heading(UnitComplex::new(angle));
            let expected = ((angle / 2.0).sin(), (angle / 2.0).cos());
            assert!(
                (turned.z - expected.0).abs() < 2e-4,
                "{degrees}: {turned:?}"
            );
            assert!(
                (turned.w - expected.1).abs() < 2e-4,
                "{degrees}: {turned:?}"
            );
        }
    }

    #[test]
    fn a_timestamp_counts_seconds_and_nanoseconds() {
        let in_2000 = Timestamp::new(946_684_801, 500_000_000);
        assert_eq!(timestamp(1_500_000_000), in_2000);
    }
}
