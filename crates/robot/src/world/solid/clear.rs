//! Whether a disc stays clear of everything solid.

use nalgebra::{Point2, Vector2};

use super::Solid;

/// Two lengths that differ by less than this, in metres, are equal.
const ROUNDING_M: f64 = 1e-9;

impl Solid {
    /// Returns true if a disc around a point of the grid frame touches nothing solid.
    pub fn is_clear(&self, middle_m: Point2<f64>, radius_m: f64) -> bool {
        self.is_path_clear([middle_m; 2], radius_m)
    }

    /// Returns true if a disc touches nothing solid while its middle moves straight between two
    /// points of the grid frame.
    pub fn is_path_clear(&self, ends_m: [Point2<f64>; 2], radius_m: f64) -> bool {
        self.is_clear_along(ends_m.map(|end| self.in_raster(end)), radius_m)
    }

    /// Returns the same for points of the raster. The distances between pixels answer for most
    /// parts of a path, and the pixels themselves for the rest.
    fn is_clear_along(&self, ends: [Point2<f64>; 2], radius_m: f64) -> bool {
        let [from, to] = ends;
        let half = (to - from) / 2.0;
        let middle = from + half;
        let [col, row] = self.pixel_of(middle);
        if self.clear_m(col, row) >= radius_m + half.norm() {
            return true;
        }
        // The middle may be half a diagonal away from the middle of its pixel.
        let reached = self.pixels_to_solid(col, row) + std::f64::consts::FRAC_1_SQRT_2;
        if reached * self.pixel_m < radius_m {
            return false;
        }
        if half.norm() > self.pixel_m {
            return [[from, middle], [middle, to]]
                .into_iter()
                .all(|part| self.is_clear_along(part, radius_m));
        }
        let reach = Vector2::repeat(radius_m);
        let low = self.pixel_of(Point2::from(from.coords.inf(&to.coords)) - reach);
        let high = self.pixel_of(Point2::from(from.coords.sup(&to.coords)) + reach);
        let mut rows = low[1]..=high[1];
        rows.all(|row| {
            let mut cols = low[0]..=high[0];
            cols.all(|col| {
                !self.is_solid(col, row) || self.apart_m(ends, [col, row]) >= radius_m - ROUNDING_M
            })
        })
    }

    /// Returns the distance between a line segment and a pixel.
    fn apart_m(&self, [from, to]: [Point2<f64>; 2], [col, row]: [i32; 2]) -> f64 {
        let corner = |x: i32, y: i32| {
            let at = Vector2::new(f64::from(col + x), f64::from(row + y));
            Point2::from(at * self.pixel_m)
        };
        let [low, high] = [corner(0, 0), corner(1, 1)];
        if crosses([from, to], [low, high]) {
            return 0.0;
        }
        // The nearest points of two shapes with straight edges include a corner of one of them.
        let ends = [from, to].map(|end| self.offset_from_pixel(end, col, row).norm());
        let corners = [low, high, corner(1, 0), corner(0, 1)];
        let corners = corners.map(|corner| from_segment(corner, [from, to]));
        ends.into_iter()
            .chain(corners)
            .fold(f64::INFINITY, f64::min)
    }
}

/// Returns the distance of a point from a line segment.
pub(super) fn from_segment(point: Point2<f64>, [from, to]: [Point2<f64>; 2]) -> f64 {
    let (way, offset) = (to - from, point - from);
    let length = way.norm_squared();
    let share = if length > 0.0 {
        (offset.dot(&way) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (offset - share * way).norm()
}

/// Returns true if a line segment has a point in a box (Liang and Barsky 1984).
fn crosses([from, to]: [Point2<f64>; 2], [low, high]: [Point2<f64>; 2]) -> bool {
    let way = to - from;
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        if way[axis] == 0.0 {
            if from[axis] < low[axis] || from[axis] > high[axis] {
                return false;
            }
            continue;
        }
        let [one, other] = [low, high].map(|side| (side[axis] - from[axis]) / way[axis]);
        enter = enter.max(one.min(other));
        leave = leave.min(one.max(other));
    }
    enter <= leave
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Origin;
    use proptest::prelude::*;

    fn solid(bits: &[bool]) -> Solid {
        Solid::new(12, bits.into(), 0.1, Origin::from([0.3, -0.2, 0.4]))
    }

    proptest! {
        #[test]
        fn a_path_is_clear_if_every_point_of_it_is(
            bits in prop::collection::vec(prop::bool::weighted(0.06), 144),
            ends in prop::array::uniform2(prop::array::uniform2(0.1..1.1_f64)),
            radius_m in 0.02..0.3_f64,
        ) {
            let solid = solid(&bits);
            let ends = ends.map(|[x, y]| solid.in_grid(Point2::new(x, y)));
            let gap = |share: f64| {
                let at = ends[0] + share * (ends[1] - ends[0]);
                let mut nearest: f64 = 0.6;
                solid.all_near(at, 0.6, |from_wall| {
                    nearest = nearest.min(from_wall.norm());
                    true
                });
                nearest
            };
            let narrowest = (0..=400).map(|step| gap(f64::from(step) / 400.0)).fold(0.6, f64::min);
            // Between two of these points the path may be a little nearer to something.
            prop_assume!(!(radius_m..radius_m + 0.003).contains(&narrowest));
            let expected = narrowest >= radius_m;
            prop_assert_eq!(solid.is_path_clear(ends, radius_m), expected, "{}", narrowest);
        }
    }

    #[test]
    fn a_disc_may_touch_both_walls_of_a_corridor() {
        let bits: Vec<bool> = (0..36).map(|at| !(12..24).contains(&at)).collect();
        let solid = Solid::new(12, bits.into(), 0.1, Origin::default());
        let ends = [Point2::new(0.25, 0.15), Point2::new(0.95, 0.15)];
        assert!(solid.is_path_clear(ends, 0.05));
        assert!(!solid.is_path_clear(ends, 0.051), "control");
        assert!(solid.is_clear(ends[0], 0.05) && !solid.is_clear(ends[0], 0.051));
    }
}
