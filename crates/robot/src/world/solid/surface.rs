//! The surfaces of the solid pixels, as the robot's map has them.

use nalgebra::{Point2, Vector2};
use xcscr_sensing::{Field, Surface};

use super::Solid;

/// Surfaces farther from a point than this, in metres, are not near it.
const NEAR_M: f64 = 1.0;
/// The share of the line from a corner to a point that lies in one pixel.
const BEGIN: f64 = 0.001;

impl Field for Solid {
    fn nearest(&self, point_m: Vector2<f64>, direction: Vector2<f64>) -> Option<Surface> {
        let at = self.in_raster(point_m.into());
        let turn = self.corner_in_grid().map(|corner| corner.rotation);
        let direction = turn.map_or(direction, |turn| turn.inverse() * direction);
        let [col, row] = self.pixel_of(at);
        if self.clear_m(col, row) > NEAR_M {
            return None;
        }
        let square = |near: Option<(f64, Surface)>| near.map_or(NEAR_M * NEAR_M, |near| near.0);
        let rings = (NEAR_M / self.pixel_m).ceil() as i32 + 1;
        // A pixel on a ring is at most a diagonal of the ring away.
        let first = self.pixels_to_solid(col, row) * std::f64::consts::FRAC_1_SQRT_2;
        let mut nearest: Option<(f64, Surface)> = None;
        for ring in first as i32..=rings {
            // Sides of pixels beyond this ring are farther away than so many pixels.
            let beyond = f64::from(ring - 1) * self.pixel_m;
            if ring > 0 && square(nearest) <= beyond * beyond {
                break;
            }
            for_ring([col, row], ring, |pixel| {
                for side in self.sides(at, pixel, direction) {
                    if side.square < square(nearest) {
                        let surface = self.surface(at, side);
                        let faces_beam = surface.normal.dot(&direction) < 0.0;
                        nearest = faces_beam.then_some((side.square, surface)).or(nearest);
                    }
                }
            });
        }
        let (_, surface) = nearest?;
        Some(Surface {
            normal: turn.map_or(surface.normal, |turn| turn * surface.normal),
            ..surface
        })
    }

    /// The error of a length that is rounded to whole pixels.
    fn deviation_m(&self) -> f64 {
        self.pixel_m / 12.0_f64.sqrt()
    }
}

/// A side of a pixel that is a surface, seen from a point.
#[derive(Clone, Copy)]
struct Side {
    /// The unit vector out of the wall.
    normal: Vector2<f64>,
    /// The vector from the nearest point of the side to the point.
    from: Vector2<f64>,
    /// The square of its length.
    square: f64,
}

impl Solid {
    /// Returns the surface of a side, seen from a point of the raster. Beside the side, its normal points
    /// to or from the nearest corner: from it if the line to the point begins in free space.
    fn surface(&self, at: Point2<f64>, side: Side) -> Surface {
        let is_beside = side.from.perp(&side.normal) != 0.0;
        if !is_beside {
            return Surface {
                normal: side.normal,
                distance_m: side.from.dot(&side.normal),
            };
        }
        let corner = at - side.from;
        let [col, row] = self.pixel_of(corner + BEGIN * side.from);
        let sign = if self.is_solid(col, row) { -1.0 } else { 1.0 };
        let distance = side.square.sqrt();
        Surface {
            normal: sign * side.from / distance,
            distance_m: sign * distance,
        }
    }

    /// Returns the sides of a pixel between solid and free that face a beam of this direction, seen from
    /// a point of the raster.
    fn sides(
        &self,
        at: Point2<f64>,
        [col, row]: [i32; 2],
        direction: Vector2<f64>,
    ) -> impl Iterator<Item = Side> + '_ {
        let is_solid = self.is_solid(col, row);
        let low = Vector2::new(f64::from(col), f64::from(row)) * self.pixel_m;
        let high = Vector2::new(f64::from(col) + 1.0, f64::from(row) + 1.0) * self.pixel_m;
        let all = [[1, 0], [-1, 0], [0, 1], [0, -1]];
        let normal = move |[x, y]: [i32; 2]| {
            let outward = Vector2::new(f64::from(x), f64::from(y));
            if is_solid { outward } else { -outward }
        };
        let open = all.into_iter().filter(move |&[x, y]| {
            let faces_beam = normal([x, y]).dot(&direction) < 0.0;
            faces_beam && self.is_solid(col + x, row + y) != is_solid
        });
        open.map(move |[x, y]| {
            // The side is the part of the pixel that is farthest in this direction.
            let end = |step: i32, low: f64, high: f64, at: f64| match step {
                1 => at - high,
                -1 => at - low,
                _ => at - at.clamp(low, high),
            };
            let from = Vector2::new(end(x, low.x, high.x, at.x), end(y, low.y, high.y, at.y));
            Side {
                normal: normal([x, y]),
                from,
                square: from.norm_squared(),
            }
        })
    }
}

/// Visits the pixels on the square ring around a pixel.
fn for_ring([col, row]: [i32; 2], ring: i32, mut visit: impl FnMut([i32; 2])) {
    if ring == 0 {
        return visit([col, row]);
    }
    for along in -ring..ring {
        visit([col + along, row - ring]);
        visit([col + ring, row + along]);
        visit([col - along, row + ring]);
        visit([col - ring, row - along]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Origin;
    use proptest::prelude::*;

    /// A raster of 8 x 6 pixels of 0.1 m, whose corner is turned and moved.
    fn solid(bits: Vec<bool>) -> Solid {
        let corner = Origin::from([0.3, -0.2, 0.4]);
        Solid::new(8, bits.into(), 0.1, corner)
    }

    /// The distance to the nearest pixel that is solid, or free, by comparing with all of them.
    fn distance(solid: &Solid, at: Point2<f64>, is_solid: bool) -> f64 {
        let pixels = (-3..9).flat_map(|row| (-3..11).map(move |col| (col, row)));
        let wanted = pixels.filter(|&(col, row)| solid.is_solid(col, row) == is_solid);
        let distances = wanted.map(|(col, row)| solid.offset_from_pixel(at, col, row).norm());
        distances.fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #[test]
        fn the_nearest_surface_is_as_far_as_the_nearest_pixel_of_the_other_kind(
            bits in prop::collection::vec(prop::bool::weighted(0.3), 48),
            x in 0.0..0.8_f64, y in 0.0..0.6_f64, turn in 0.0..std::f64::consts::TAU,
        ) {
            let solid = solid(bits);
            let at = Point2::new(x, y);
            let [col, row] = solid.pixel_of(at);
            let is_inside = solid.is_solid(col, row);
            let expected = distance(&solid, at, !is_inside);
            let point = solid.in_grid(at);
            let beam = Vector2::new(turn.cos(), turn.sin());
            let ends = [beam, -beam].map(|beam| (beam, solid.nearest(point.coords, beam)));
            let distances = ends.iter().filter_map(|(_, found)| Some(found.as_ref()?.distance_m.abs()));
            let found = distances.fold(NEAR_M, f64::min);
            prop_assert!((found - expected.min(NEAR_M)).abs() < 1e-9, "{} {}", found, expected);
            for (beam, surface) in ends.into_iter().filter_map(|(beam, found)| Some((beam, found?))) {
                prop_assert!(surface.normal.dot(&beam) < 0.0, "{:?}", surface);
                prop_assert!((surface.normal.norm() - 1.0).abs() < 1e-9);
                // A little further along the normal is free, and a little back is solid.
                let foot = point - surface.distance_m * surface.normal;
                let beside = |step: f64| solid.is_solid_at(foot + step * surface.normal);
                prop_assert!(!beside(1e-6) || beside(-1e-6), "{:?}", surface);
            }
        }
    }

    #[test]
    fn a_point_on_a_surface_has_the_normal_of_its_side() {
        let bits = (0..48).map(|at| at % 8 > 4).collect();
        let solid = Solid::new(8, bits, 0.125, Origin::default());
        for x in [0.625 - 1e-12, 0.625, 0.625 + 1e-12] {
            let surface = solid.nearest(Vector2::new(x, 0.3), Vector2::x()).unwrap();
            assert_eq!(surface.normal, -Vector2::x());
            assert!((surface.distance_m - (0.625 - x)).abs() < 1e-15);
        }
        // Beside a convex corner the normal points away from the corner.
        let bits = (0..48).map(|at| at % 8 > 4 && at / 8 > 2).collect();
        let corner = Solid::new(8, bits, 0.125, Origin::default());
        let beside = Vector2::new(0.625 - 0.03, 0.375 + 0.04);
        let surface = corner.nearest(beside, Vector2::new(0.6, -0.8));
        let expected = Vector2::new(-0.6, 0.8);
        assert!((surface.unwrap().normal - expected).norm() < 1e-9);
    }

    #[test]
    fn a_beam_that_ends_behind_a_thin_wall_hit_its_front() {
        let bits = (0..48).map(|at| at % 8 == 5).collect();
        let wall = Solid::new(8, bits, 0.125, Origin::default());
        let behind = Vector2::new(0.75 + 0.05, 0.3);
        let seen = |beam| wall.nearest(behind, beam).unwrap();
        let [front, back] = [Vector2::x(), -Vector2::x()].map(seen);
        assert_eq!((front.normal, back.normal), (-Vector2::x(), Vector2::x()));
        assert!((front.distance_m + 0.175).abs() < 1e-9, "{front:?}");
        assert!((back.distance_m - 0.05).abs() < 1e-9, "control: {back:?}");
    }
}
