//! Rotations with the same result on every platform.

use nalgebra::{Complex, UnitComplex, Vector2};

/// Returns the square of a number.
pub fn square(number: f64) -> f64 {
    number * number
}

/// Returns the unit vector along the heading of a rotation.
pub fn ahead(rotation: UnitComplex<f64>) -> Vector2<f64> {
    Vector2::new(rotation.re, rotation.im)
}

/// Returns the rotation by an angle. Angles of a single step use a power series, whose error is
/// below 1e-10.
pub fn rotation(angle_rad: f64) -> UnitComplex<f64> {
    let square = angle_rad * angle_rad;
    let (sine, cosine) = if square < 0.4 {
        let sine = 1.0
            - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)));
        let cosine = 1.0
            - square / 2.0
                * (1.0
                    - square / 12.0
                        * (1.0 - square / 30.0 * (1.0 - square / 56.0 * (1.0 - square / 90.0))));
        (angle_rad * sine, cosine)
    } else {
        libm::sincos(angle_rad)
    };
    UnitComplex::new_unchecked(Complex::new(cosine, sine))
}

/// Returns the rotation by a small angle, without sine and cosine (Cayley's formula).
pub fn cayley(angle_rad: f64) -> UnitComplex<f64> {
    let quarter = angle_rad * angle_rad / 4.0;
    let over = 1.0 + quarter;
    UnitComplex::new_unchecked(Complex::new((1.0 - quarter) / over, angle_rad / over))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_matches_sine_and_cosine() {
        for step in -40..=40 {
            let angle_rad = f64::from(step) / 20.0;
            let (sine, cosine) = libm::sincos(angle_rad);
            let found = rotation(angle_rad);
            let error = (found.re - cosine).abs().max((found.im - sine).abs());
            assert!(error < 1e-9, "{angle_rad}: {error}");
        }
    }

    #[test]
    fn cayley_matches_for_a_small_angle() {
        let difference = cayley(0.01) * rotation(0.01).inverse();
        assert!(difference.im.abs() < 1e-7, "{difference}");
    }
}
