//! The arrow, from which all arrows come by turning and scaling.

use std::f64::consts::FRAC_1_SQRT_2;

use crate::world::Direction;

/// The colours of best actions far from the goal along the policy, half-way, and near it. Their lightness falls, so that
/// colour-blind viewers see the order, too.
pub(crate) const SCALE: [u32; 3] = [0xe6ac00, 0x1f8f8a, 0x45106b];
/// The colour of best actions that lead to no goal.
pub(crate) const NO_GOAL: u32 = 0x9aa3b0;

/// The arrow of length 1 that points east, from its tail at the origin; y downward.
pub(super) const OUTLINE: [(f64, f64); 7] = [
    (0.0, -0.07),
    (0.58, -0.07),
    (0.58, -0.24),
    (1.0, 0.0),
    (0.58, 0.24),
    (0.58, 0.07),
    (0.0, 0.07),
];

/// Where an arrow points: one of eight directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Heading(Direction);

impl Heading {
    /// The heading of a compass direction.
    pub fn new(direction: Direction) -> Self {
        Self(direction)
    }

    /// Degrees clockwise from east, for SVG.
    pub fn degrees(self) -> i32 {
        let eighths = Direction::CLOCKWISE.iter().position(|&d| d == self.0);
        45 * eighths.unwrap_or(0) as i32 - 90
    }

    /// Cosine and sine of the angle from east, clockwise, without any trigonometry.
    fn cos_sin(self) -> (f64, f64) {
        let (east, south) = self.0.offset();
        let unit = match east != 0 && south != 0 {
            true => FRAC_1_SQRT_2,
            false => 1.0,
        };
        (f64::from(east) * unit, f64::from(south) * unit)
    }

    /// The outline of an arrow.
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
        // Relative luminance, as WCAG 2 defines it.
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
        // Differences that are seen without any hue: contrasts of at least 1.5.
        for pair in luminance.windows(2) {
            assert!((pair[0] + 0.05) / (pair[1] + 0.05) > 1.5, "{luminance:?}");
        }
    }

    #[test]
    fn the_tip_lies_where_the_direction_says_and_degrees_agree() {
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
