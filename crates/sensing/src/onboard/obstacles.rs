//! What the lidar sees that is not in the map.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::estimator::Ray;
use super::field::Field;

/// A beam that ends nearer than this to a surface of the map, in metres, ends at this surface: a
/// constant part, and a share of the range.
const EXPLAINED_M: f64 = 0.1;
const EXPLAINED_SHARE: f64 = 0.05;
/// Two beams that end nearer to each other than this, in metres, end at the same obstacle. A single
/// beam may be wrong.
const SAME_M: f64 = 0.1;

/// The ends of the beams of the last action that ended at no surface of the map.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Obstacles {
    points: Vec<Vector2<f64>>,
}

impl Obstacles {
    /// Forgets everything.
    pub(crate) fn forget(&mut self) {
        self.points.clear();
    }

    /// Adds the end of a beam, unless the map explains it. A beam that hit something too near to be
    /// measured ends after `nearest_m`.
    pub(crate) fn see(&mut self, map: &dyn Field, ray: &Ray, nearest_m: f64) {
        let Some(range) = ray.range.map(|range| range.max(nearest_m)) else {
            return;
        };
        let end = ray.origin + range * ray.direction;
        let explained = EXPLAINED_M + EXPLAINED_SHARE * range;
        let is_explained = match map.nearest(end) {
            Some(surface) => surface.distance_m < explained,
            None => map.is_solid(end),
        };
        if !is_explained {
            self.points.push(end);
        }
    }

    /// Returns true if a disc would touch an obstacle while its middle moves straight between two
    /// points of the grid frame.
    pub fn are_on_path(&self, ends_m: [Vector2<f64>; 2], radius_m: f64) -> bool {
        let [from, to] = ends_m;
        let (way, length) = (to - from, (to - from).norm_squared());
        let is_on_path = |point: &&Vector2<f64>| {
            let share = ((*point - from).dot(&way) / length).clamp(0.0, 1.0);
            (*point - from - share * way).norm_squared() < radius_m * radius_m
        };
        let mut on_path = self.points.iter().filter(is_on_path);
        let mut before: Vec<Vector2<f64>> = Vec::new();
        on_path.any(|point| {
            let is_same = |other: &Vector2<f64>| (point - other).norm_squared() < SAME_M * SAME_M;
            let agrees = before.iter().any(is_same);
            before.push(*point);
            agrees
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::onboard::field::Surface;

    /// A wall at x = 2, solid beyond it.
    #[derive(Debug)]
    struct Wall;

    impl Field for Wall {
        fn nearest(&self, point_m: Vector2<f64>) -> Option<Surface> {
            let distance_m = 2.0 - point_m.x;
            let normal = -Vector2::x();
            (distance_m.abs() < 0.3).then_some(Surface { normal, distance_m })
        }

        fn deviation_m(&self) -> f64 {
            0.0
        }

        fn is_solid(&self, point_m: Vector2<f64>) -> bool {
            point_m.x > 2.0
        }
    }

    /// Beams from the origin that end at these points.
    fn seen(ends: &[[f64; 2]]) -> Obstacles {
        let mut obstacles = Obstacles::default();
        for &end in ends {
            let end = Vector2::from(end);
            let ray = Ray {
                origin: Vector2::zeros(),
                direction: end.normalize(),
                range: Some(end.norm()),
            };
            obstacles.see(&Wall, &ray, 0.12);
        }
        obstacles
    }

    const PATH: [Vector2<f64>; 2] = [Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0)];

    #[test]
    fn beams_at_the_walls_of_the_map_are_no_obstacles() {
        for x in [1.85, 2.0, 2.2, 5.0] {
            assert_eq!(seen(&[[x, 0.1], [x, 0.12]]), Obstacles::default(), "{x}");
        }
        assert_ne!(seen(&[[1.7, 0.1]]), Obstacles::default(), "control");
    }

    #[test]
    fn two_beams_that_end_near_each_other_on_the_path_are_an_obstacle() {
        let is_blocked = |ends: &[[f64; 2]]| seen(ends).are_on_path(PATH, 0.2);
        assert!(is_blocked(&[[0.5, 0.1], [0.5, 0.15]]));
        assert!(is_blocked(&[[0.5, 0.1], [0.9, 0.9], [0.5, 0.15]]));
        assert!(!is_blocked(&[[0.5, 0.1]]), "one beam may be wrong");
        assert!(!is_blocked(&[[0.5, 0.1], [0.9, 0.1]]), "two may be wrong");
        assert!(!is_blocked(&[[0.5, 0.25], [0.5, 0.3]]), "beside the path");
        assert!(!is_blocked(&[[1.3, 0.0], [1.3, 0.05]]), "behind its end");
    }
}
