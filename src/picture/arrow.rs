//! The arrow shape. All arrows are rotated and scaled copies of it.

use std::f64::consts::FRAC_1_SQRT_2;

use crate::world::Direction;

/// Colours of best actions, by distance to the goal along the policy: far, halfway, near. Their
/// lightness decreases, so that the order is visible to colour-blind viewers.
pub(crate) const SCALE: [u32; 3] = [0xe6ac00, 0x1f8f8a, 0x45106b];
/// The colour of best actions that do not lead to a goal.
pub(crate) const NO_GOAL: u32 = 0x9aa3b0;

/// Outline of an arrow of length 1 that points east, with its tail at the origin; y points down.
pub(super) const OUTLINE: [(f64, f64); 7] = [
    (0.0, -0.07),
    (0.58, -0.07),
    (0.58, -0.24),
    (1.0, 0.0),
    (0.58, 0.24),
    (0.58, 0.07),
    (0.0, 0.07),
];

/// The direction of an arrow, one of eight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Heading(Direction);

impl Heading {
    /// Creates the heading of a compass direction.
    pub fn new(direction: Direction) -> Self {
        Self(direction)
    }

    /// Returns degrees clockwise from east, for SVG.
    pub fn degrees(self) -> i32 {
        let eighths = Direction::CLOCKWISE.iter().position(|&d| d == self.0);
        45 * eighths.unwrap_or(0) as i32 - 90
    }

    /// Returns cosine and sine of the angle clockwise from east, without trigonometric functions.
    fn cos_sin(self) -> (f64, f64) {
        let (east, south) = self.0.offset();
        let unit = match east != 0 && south != 0 {
            true => FRAC_1_SQRT_2,
            false => 1.0,
        };
        (f64::from(east) * unit, f64::from(south) * unit)
    }

    /// Returns the outline of an arrow.
    pub fn outline(self, tail: (f64, f64), length: f64) -> [(f64, f64); 7] {
        let (cos, sin) = self.cos_sin();
        OUTLINE.map(|(x, y)| {
            (
                tail.0 + length * (x * cos - y * sin),
                tail.1 + length * (x * sin + y * cos),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_get_darker_toward_the_goal() {
        // Relative luminance as defined by WCAG 2.
        let luminance = SCALE.map(|rgb| {
            let part = |shift: u32| {
                let part = f64::from(rgb >> shift & 0xff) / 255.0;
                if part <= 0.04045 {
                    part / 12.92
                } else {
                    ((part + 0.055) / 1.055).powf(2.4)
                }
            };
            0.2126 * part(16) + 0.7152 * part(8) + 0.0722 * part(0)
        });
        // A contrast of at least 1.5 is visible without hue.
        for pair in luminance.windows(2) {
            assert!((pair[0] + 0.05) / (pair[1] + 0.05) > 1.5, "{luminance:?}");
        }
    }

    #[test]
    fn the_tip_points_in_the_direction_and_degrees_agree() {
        for direction in Direction::CLOCKWISE {
            let heading = Heading::new(direction);
            let (x, y) = heading.outline((0.0, 0.0), 2.0)[3];
            let (east, south) = direction.offset();
            let norm = f64::from(east * east + south * south).sqrt();
            let expected = (2.0 * f64::from(east) / norm, 2.0 * f64::from(south) / norm);
            assert!(
                (x - expected.0).abs() < 1e-9 && (y - expected.1).abs() < 1e-9,
                "{direction:?}"
            );
            let angle = f64::from(heading.degrees()).to_radians();
            assert!(
                (2.0 * angle.cos() - x).abs() < 1e-9 && (2.0 * angle.sin() - y).abs() < 1e-9,
                "{direction:?}"
            );
        }
    }
}
