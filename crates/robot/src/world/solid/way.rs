//! The widest way between two points.

use std::collections::BinaryHeap;

use nalgebra::Point2;

use super::Solid;

/// The narrowest place of a way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Narrowest {
    /// The place in the grid frame, in metres.
    pub at: Point2<f64>,
    /// The width of the way at this place, in metres.
    pub width_m: f64,
}

impl Solid {
    /// Returns the narrowest place of the widest way between two points of the grid frame; `None`
    /// if there is no way.
    pub fn narrowest_between(&self, [from, to]: [Point2<f64>; 2]) -> Option<Narrowest> {
        let [from, to] = [from, to].map(|end| {
            let [col, row] = self.pixel_of(self.in_raster(end));
            (!self.is_solid(col, row)).then_some([col, row])
        });
        let (from, to) = (from?, to?);
        let at = |[col, row]: [i32; 2]| row as usize * self.width + col as usize;
        // The widest pixels come first; each entry also has the narrowest pixel on its way.
        let entry = |pixel: [i32; 2], least: (u32, [i32; 2])| {
            let width = self.squares_to_solid(pixel);
            (
                width.min(least.0),
                if width < least.0 { pixel } else { least.1 },
                pixel,
            )
        };
        let mut seen = vec![false; self.bits.len()];
        let mut next = BinaryHeap::from([entry(from, (u32::MAX, from))]);
        while let Some((width, narrowest, pixel)) = next.pop() {
            if std::mem::replace(&mut seen[at(pixel)], true) {
                continue;
            }
            if pixel == to {
                return Some(self.narrowest(width, narrowest));
            }
            let [col, row] = pixel;
            for beside in [
                [col + 1, row],
                [col - 1, row],
                [col, row + 1],
                [col, row - 1],
            ] {
                if !self.is_solid(beside[0], beside[1]) && !seen[at(beside)] {
                    next.push(entry(beside, (width, narrowest)));
                }
            }
        }
        None
    }

    fn narrowest(&self, squares: u32, [col, row]: [i32; 2]) -> Narrowest {
        let middle = [col, row].map(|number| (f64::from(number) + 0.5) * self.pixel_m);
        Narrowest {
            at: self.in_grid(middle.into()),
            // From the middle of a free pixel to the near sides of solid pixels.
            width_m: (2.0 * f64::from(squares).sqrt() - 1.0) * self.pixel_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Origin;

    #[test]
    fn the_widest_of_two_doors_is_found_with_its_width() {
        // Two rooms of 6 x 9 pixels, and doors of one and of three pixels.
        let is_door = |row: usize| row == 1 || (5..8).contains(&row);
        let rooms = |is_door: &dyn Fn(usize) -> bool| {
            let bits = (0..117).map(|at| at % 13 == 6 && !is_door(at / 13));
            Solid::new(13, bits.collect(), 0.1, Origin::default())
        };
        let ends = [Point2::new(0.25, 0.45), Point2::new(1.05, 0.45)];
        let found = rooms(&is_door).narrowest_between(ends).unwrap();
        assert!((found.width_m - 0.3).abs() < 1e-9, "{found:?}");
        assert!(
            (found.at - Point2::new(0.65, 0.25)).norm() < 1e-9,
            "{found:?}"
        );
        assert_eq!(rooms(&|_| false).narrowest_between(ends), None);
    }
}
