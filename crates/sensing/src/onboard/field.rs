//! The robot's map: where the surfaces of the walls are.

use std::fmt::Debug;

use nalgebra::Vector2;

/// A map that the robot is given. Without one, the robot assumes that walls are on the lines of its
/// grid.
pub trait Field: Debug + Send + Sync {
    /// Returns the surface nearest to a point of the grid frame, among those that face a beam of this
    /// direction; `None` if none is near. A beam that ends behind a thin wall hit its front.
    fn nearest(&self, point_m: Vector2<f64>, direction: Vector2<f64>) -> Option<Surface>;

    /// Returns the standard deviation of the surfaces in the map from those of the walls, in metres.
    fn deviation_m(&self) -> f64;
}

/// A piece of the surface of a wall, seen from a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// The unit vector out of the wall, in the grid frame.
    pub normal: Vector2<f64>,
    /// The distance of the point from the surface in metres; negative behind it.
    pub distance_m: f64,
}
