//! Building blocks of 3D scenes.

use foxglove::messages::{
    Color, CubePrimitive, Point3, Pose, Quaternion, SceneEntity, SceneUpdate, TextPrimitive,
    Timestamp, Vector3,
};
use nalgebra::{Point2, UnitComplex};

use super::rounded;

/// The grid frame, in which all static objects are drawn: origin in the south-western corner, x
/// east, y north, z up.
pub(in crate::record) const WORLD: &str = "world";
/// The map frame of worlds with an `origin`. Other worlds use the grid frame in its place.
pub(super) const MAP: &str = "map";
/// The robot's frame: origin on the floor below its middle, x ahead, y to the left.
pub(in crate::record) const ROBOT: &str = "robot";
/// The robot's frame at its estimated pose, relative to its true pose.
pub(in crate::record) const ESTIMATE: &str = "estimate";

/// Converts a time of the simulation clock.
pub(in crate::record) fn timestamp(time_ns: u64) -> Timestamp {
    const SECOND: u64 = 1_000_000_000;
    let sec = u32::try_from(time_ns / SECOND).unwrap_or(u32::MAX);
    Timestamp::new(sec, (time_ns % SECOND) as u32)
}

/// Returns the colour `0xRRGGBB` with an opacity from 0 to 1.
pub(super) fn color(rgb: u32, opacity: f64) -> Option<Color> {
    let part = |shift: u32| rounded(f64::from(rgb >> shift & 0xff) / 255.0);
    Some(Color {
        r: part(16),
        g: part(8),
        b: part(0),
        a: rounded(opacity),
    })
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
        z: rounded(half(-heading.re).copysign(heading.im)),
        w: rounded(half(heading.re)),
    }
}

/// Returns a pose at a position, with the axes of the frame.
pub(super) fn place(x: f64, y: f64, z: f64) -> Option<Pose> {
    Some(Pose {
        position: Some(vector(x, y, z)),
        orientation: Some(Quaternion {
            w: 1.0,
            ..Quaternion::default()
        }),
    })
}

pub(super) fn cube(pose: Option<Pose>, size: Vector3, color: Option<Color>) -> CubePrimitive {
    CubePrimitive {
        pose,
        size: Some(size),
        color,
    }
}

/// Creates text that lies on the floor and reads from the south.
pub(super) fn words(pose: Option<Pose>, height: f64, rgb: u32, text: &str) -> TextPrimitive {
    TextPrimitive {
        pose,
        billboard: false,
        font_size: rounded(height),
        scale_invariant: false,
        color: color(rgb, 1.0),
        text: text.to_owned(),
    }
}

/// Creates an empty entity.
pub(super) fn entity(id: &str, frame: &str, time_ns: u64) -> SceneEntity {
    SceneEntity {
        timestamp: Some(timestamp(time_ns)),
        frame_id: frame.to_owned(),
        id: id.to_owned(),
        frame_locked: frame != WORLD,
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
        assert_eq!(timestamp(1_500_000_000), Timestamp::new(1, 500_000_000));
    }
}
