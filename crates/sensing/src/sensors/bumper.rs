//! The bumper: two sectors that close a switch.

use nalgebra::UnitComplex;

use super::{Push, ahead};

/// The cosine of half a sector: 45 degrees to each side.
const SECTOR: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Returns whether the front and the rear sector are pushed by more than `threshold`. `rotation` is
/// the heading of the robot.
pub(super) fn read(rotation: UnitComplex<f64>, pushes: &[Push], threshold: f64) -> [bool; 2] {
    let front = ahead(rotation);
    let hit = |way: f64| {
        let in_sector = |push: &&Push| way * push.normal.dot(&front) >= SECTOR;
        let impulse: f64 = pushes.iter().filter(in_sector).map(|p| p.impulse_n_s).sum();
        impulse > threshold
    };
    [hit(1.0), hit(-1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Complex, Vector2};

    fn push(x: f64, y: f64, impulse_n_s: f64) -> Push {
        let normal = Vector2::new(x, y);
        Push {
            normal,
            impulse_n_s,
        }
    }

    #[test]
    fn each_sector_covers_45_degrees_to_each_side() {
        let north = UnitComplex::new_unchecked(Complex::new(0.0, 1.0));
        assert_eq!(read(north, &[push(0.6, 0.8, 1.0)], 0.3), [true, false]);
        assert_eq!(read(north, &[push(0.6, -0.8, 1.0)], 0.3), [false, true]);
        assert_eq!(read(north, &[push(0.8, 0.6, 1.0)], 0.3), [false, false]);
    }

    #[test]
    fn a_touch_below_the_threshold_closes_no_switch() {
        let east = UnitComplex::identity();
        assert_eq!(read(east, &[push(1.0, 0.0, 0.3)], 0.3), [false, false]);
        let pushes = [push(1.0, 0.0, 0.2), push(0.8, 0.6, 0.2)];
        assert_eq!(read(east, &pushes, 0.3), [true, false], "two add up");
    }
}
