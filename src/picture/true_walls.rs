//! The walls of a world from a map in their true shape.

use nalgebra::{Point2, Vector2};

use super::colours::css;
use super::drawing::{FLOOR, HEAD, Plane, WALL};
use super::svg::{Element, short};

impl Plane<'_> {
    /// Returns the part of the picture that the raster of the walls covers.
    pub fn raster(&self) -> Option<Element> {
        let solid = self.maze.solid();
        let size = solid.size().map(|pixels| pixels as f64 * solid.pixel_m());
        let middle = solid.in_grid(Point2::from(size) / 2.0);
        self.rectangle(middle, size, FLOOR)
    }

    /// Returns the walls in their true shape; nothing in a maze.
    pub fn true_walls(&self) -> Vec<Element> {
        if !self.maze.is_from_map() {
            return Vec::new();
        }
        let solid = self.maze.solid();
        let blocks = solid.blocks();
        let wall = |block| self.rectangle(solid.middle_of(block), solid.size_of(block), WALL);
        blocks.iter().filter_map(wall).collect()
    }

    /// Returns a rectangle along the pixels of the walls, given in metres of the grid frame, as far
    /// as it is in the picture of the maze.
    fn rectangle(&self, middle: Point2<f64>, size: [f64; 2], fill: u32) -> Option<Element> {
        let px_per_m = self.cell / self.maze.cell_size_m();
        let [wide, high] =
            [self.maze.width(), self.maze.height()].map(|cells| f64::from(cells) * self.cell);
        let corner = self
            .maze
            .solid()
            .corner_in_grid()
            .copied()
            .unwrap_or_default();
        let half = Vector2::from(size) / 2.0;
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| {
            let at = middle + corner.rotation * half.component_mul(&Vector2::new(x, y));
            Point2::new(at.x * px_per_m, high - at.y * px_per_m)
        });
        let mut shape = corners.to_vec();
        for axis in 0..2 {
            shape = clipped(&shape, |at| at[axis]);
            shape = clipped(&shape, |at| [wide, high][axis] - at[axis]);
        }
        let points: Vec<String> = shape
            .iter()
            .map(|at| format!("{},{}", short(self.left + at.x), short(HEAD + at.y)))
            .collect();
        let attributes = [("points", points.join(" ")), ("fill", css(fill))];
        (!shape.is_empty()).then(|| Element::new("polygon", attributes))
    }
}

/// Returns the part of a polygon in which `inside` is not negative (Sutherland and Hodgman 1974).
fn clipped(polygon: &[Point2<f64>], inside: impl Fn(&Point2<f64>) -> f64) -> Vec<Point2<f64>> {
    let mut part = Vec::new();
    for (number, to) in polygon.iter().enumerate() {
        let from = &polygon[(number + polygon.len() - 1) % polygon.len()];
        let [before, after] = [inside(from), inside(to)];
        if (before < 0.0) != (after < 0.0) {
            part.push(from + (to - from) * (before / (before - after)));
        }
        if after >= 0.0 {
            part.push(*to);
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Maze;

    #[test]
    fn walls_are_drawn_in_their_shape_and_end_where_the_maze_ends() {
        let text = r######"{ "rows": ["####", "#SG#", "####"], "solid": { "pixel_m": 0.5,
            "corner": [-0.5, 0.5, 0.0], "radius_m": 0.3, "rows": ["8#", "3#4.1#", "3#4.1#", "8#"] } }"######;
        let maze = Maze::from_json(text.as_bytes(), "hall.json").unwrap();
        let plane = |maze| Plane {
            maze,
            cell: 10.0,
            left: 0.0,
        };
        let walls = plane(&maze).true_walls();
        // The frame of the corridor: above, on the left, on the right and below.
        let shape = |left: i32, top: i32, right: i32, bottom: i32| {
            let corners = [[left, bottom], [right, bottom], [right, top], [left, top]];
            let point = |[x, y]: [i32; 2]| format!("{x},{}", HEAD as i32 + y);
            let points = corners.map(point).join(" ");
            Element::new("polygon", [("points", points), ("fill", css(WALL))])
        };
        assert_eq!(walls.len(), 4);
        assert_eq!(walls[0], shape(0, 5, 35, 10));
        assert_eq!(walls[2], shape(30, 10, 35, 25));
        let maze = r#####"{ "rows": ["####", "#SG#", "####"] }"#####;
        let maze = Maze::from_json(maze.as_bytes(), "hall.json").unwrap();
        assert_eq!(plane(&maze).true_walls(), [], "control: a maze");
    }
}
