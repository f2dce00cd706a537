//! What the lidar sees on a path that is clear in the map.

use nalgebra::Vector2;

use super::estimator::Ray;

/// The smallest cosine of the angle between a path and a beam along it: 25 degrees. Beams to the
/// walls beside the path are no evidence about it.
const ALONG: f64 = 0.9;
/// The number of beams that must end on a path, because a single one may be wrong.
const ENOUGH: usize = 2;

/// The beams of the last action.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Obstacles {
    /// The first and the last point of each beam in the grid frame, in metres.
    beams: Vec<[Vector2<f64>; 2]>,
}

impl Obstacles {
    /// Forgets everything.
    pub(crate) fn forget(&mut self) {
        self.beams.clear();
    }

    /// Adds a beam. A beam that hit something too near to be measured ends after `nearest_m`, and a
    /// beam that does not come back after `lost_m`.
    pub(crate) fn see(&mut self, ray: &Ray, [nearest_m, lost_m]: [f64; 2]) {
        let range = ray.range.map_or(lost_m, |range| range.max(nearest_m));
        self.beams
            .push([ray.origin, ray.origin + range * ray.direction]);
    }

    /// Returns true if something is on a path of this half width between two points of the grid
    /// frame: more beams along the path end on it than pass its end.
    pub fn are_on_path(&self, ends_m: [Vector2<f64>; 2], half_width_m: f64) -> bool {
        let way = ends_m[1] - ends_m[0];
        let length = way.norm();
        let along = way / length;
        // The distances along the path and to its left.
        let in_path = |point: Vector2<f64>| {
            let offset = point - ends_m[0];
            [offset.dot(&along), along.perp(&offset)]
        };
        let (mut ended, mut passed) = (0, 0);
        for &[from, to] in &self.beams {
            let beam = to - from;
            if beam.dot(&along) < ALONG * beam.norm() {
                continue;
            }
            let ([first, first_left], [last, last_left]) = (in_path(from), in_path(to));
            if last < length {
                ended += usize::from(last > 0.0 && last_left.abs() < half_width_m);
            } else if first < length {
                let share = (length - first) / (last - first);
                let left = first_left + share * (last_left - first_left);
                passed += usize::from(left.abs() < half_width_m);
            }
        }
        ended >= ENOUGH && ended > passed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATH: [Vector2<f64>; 2] = [Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0)];

    /// Returns true if beams from the origin that end at these points show an obstacle on the path.
    fn is_blocked(ends: &[[f64; 2]]) -> bool {
        let mut obstacles = Obstacles::default();
        for &end in ends {
            let end = Vector2::from(end);
            let ray = Ray {
                origin: Vector2::zeros(),
                direction: end.normalize(),
                range: Some(end.norm()).filter(|&range| range < 5.0),
            };
            obstacles.see(&ray, [0.12, 3.0]);
        }
        obstacles.are_on_path(PATH, 0.2)
    }

    #[test]
    fn beams_that_end_on_the_path_are_an_obstacle() {
        assert!(is_blocked(&[[0.5, 0.1], [0.5, 0.0]]));
        assert!(is_blocked(&[[0.5, 0.1], [0.5, 0.0], [2.0, 0.0]]));
        assert!(
            is_blocked(&[[0.05, 0.0], [0.06, 0.0]]),
            "too near to be measured"
        );
    }

    #[test]
    fn single_beams_and_beams_beside_or_beyond_the_path_are_no_obstacle() {
        assert!(!is_blocked(&[[0.5, 0.1]]), "one beam may be wrong");
        let passed = [[0.5, 0.1], [0.5, 0.0], [2.0, 0.0], [2.0, 0.1]];
        assert!(!is_blocked(&passed), "as many beams pass");
        let lost = [[0.5, 0.1], [0.5, 0.0], [9.0, 0.0], [9.0, 0.1]];
        assert!(!is_blocked(&lost), "as many beams do not come back");
        assert!(!is_blocked(&[[0.9, 0.25], [0.9, 0.3]]), "beside the path");
        assert!(!is_blocked(&[[1.1, 0.0], [1.1, 0.1]]), "behind its end");
        assert!(
            !is_blocked(&[[0.1, 0.15], [0.1, -0.15]]),
            "a wall beside the robot"
        );
    }
}
