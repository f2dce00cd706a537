//! Scenes seen from above: triangles and lines in the plane of the floor.

use foxglove::messages::{
    Color, LinePrimitive, Point3, Pose, SceneUpdate, TriangleListPrimitive, line_primitive,
};
use serde::Serialize;

use crate::record::topics::{GRID, decimal};

/// The scene of a topic from a time on.
#[derive(Debug, Serialize)]
pub struct Scene {
    /// The start time, in seconds.
    pub t: f64,
    shapes: Vec<Shape>,
}

/// Triangles or line segments of one colour.
#[derive(Debug, PartialEq, Serialize)]
struct Shape {
    kind: &'static str,
    /// The CSS colour with opacity.
    colour: String,
    /// The width of lines, in metres; 0 for the thinnest possible line.
    width: f64,
    /// x and y of each corner, or of both ends of each segment, in metres in the grid frame.
    points: Vec<f64>,
}

impl Scene {
    /// Converts the entities in the grid frame. Entities of other frames move with the robot, and
    /// are omitted.
    pub fn of(t: f64, scene: &SceneUpdate) -> Self {
        let entities = scene.entities.iter();
        let drawn = entities.filter(|entity| entity.frame_id == GRID);
        let shapes = drawn.flat_map(|entity| {
            let triangles = entity.triangles.iter().map(triangles);
            triangles.chain(entity.lines.iter().map(lines))
        });
        Self {
            t,
            shapes: shapes.filter(|shape| !shape.points.is_empty()).collect(),
        }
    }
}

fn triangles(list: &TriangleListPrimitive) -> Shape {
    let corners = indexed(&list.points, &list.indices);
    Shape {
        kind: "triangles",
        colour: css(list.color.as_ref()),
        width: 0.0,
        points: flat(&corners, list.pose.as_ref()),
    }
}

fn lines(line: &LinePrimitive) -> Shape {
    let points = indexed(&line.points, &line.indices);
    let ends = match line_primitive::Type::try_from(line.r#type) {
        Ok(line_primitive::Type::LineList) => points,
        kind => {
            let closing = points.first().copied();
            let closing = closing.filter(|_| kind == Ok(line_primitive::Type::LineLoop));
            let path: Vec<Point3> = points.into_iter().chain(closing).collect();
            path.windows(2).flatten().copied().collect()
        }
    };
    Shape {
        kind: "lines",
        colour: css(line.color.as_ref()),
        width: if line.scale_invariant {
            0.0
        } else {
            line.thickness
        },
        points: flat(&ends, line.pose.as_ref()),
    }
}

/// Returns the points selected by the indices, or all points without indices. Invalid indices are
/// omitted.
fn indexed(points: &[Point3], indices: &[u32]) -> Vec<Point3> {
    match indices {
        [] => points.to_vec(),
        _ => {
            let named = indices.iter();
            named
                .filter_map(|&at| points.get(at as usize).copied())
                .collect()
        }
    }
}

/// Returns x and y of points, rounded to millimetres. Poses of our scenes are translations only.
fn flat(points: &[Point3], pose: Option<&Pose>) -> Vec<f64> {
    let by = pose.and_then(|pose| pose.position).unwrap_or_default();
    let both = points.iter().flat_map(|at| [at.x + by.x, at.y + by.y]);
    both.map(decimal).collect()
}

fn css(color: Option<&Color>) -> String {
    let Color { r, g, b, a } = color.copied().unwrap_or_default();
    let [r, g, b, a] = [r, g, b, a].map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}{a:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64) -> Point3 {
        Point3 { x, y, z: 0.5 }
    }

    #[test]
    fn a_loop_is_closed_and_a_list_is_not() {
        let line = |kind: line_primitive::Type| LinePrimitive {
            r#type: kind as i32,
            points: vec![
                point(0.0, 0.0),
                point(1.0, 0.0),
                point(1.0, 1.0),
                point(0.0, 1.0),
            ],
            ..LinePrimitive::default()
        };
        let segments = |kind| lines(&line(kind)).points.len() / 4;
        assert_eq!(segments(line_primitive::Type::LineList), 2);
        assert_eq!(segments(line_primitive::Type::LineStrip), 3);
        assert_eq!(segments(line_primitive::Type::LineLoop), 4);
    }

    #[test]
    fn indices_of_no_point_draw_nothing() {
        let points = [point(0.0, 0.0), point(1.0, 2.0)];
        assert_eq!(indexed(&points, &[1, 9]), [point(1.0, 2.0)]);
    }
}
