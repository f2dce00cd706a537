//! Fast rounding to whole numbers.
//!
//! The results are bit-identical to `f64::floor` and `f64::round` for numbers as large as
//! coordinates. On the baseline of x86-64 the standard functions are calls, and each beam of the
//! lidar needs several.

/// Adding and subtracting this number removes all fractional digits.
const SHIFT: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52

/// Returns the largest whole number not above `number`, whose magnitude must be below 2^51.
pub fn floor(number: f64) -> f64 {
    let near = (number + SHIFT) - SHIFT;
    if near > number { near - 1.0 } else { near }
}

/// Returns the whole number nearest to `number`, whose magnitude must be below 2^51. Halves round
/// away from zero.
pub fn round(number: f64) -> f64 {
    let near = (number + SHIFT) - SHIFT;
    let off = number - near;
    // A half went to the even side, which may be the one toward zero.
    if off == 0.5 && number > 0.0 {
        near + 1.0
    } else if off == -0.5 && number < 0.0 {
        near - 1.0
    } else {
        near
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn agree(number: f64) {
        assert_eq!(floor(number), number.floor(), "{number:?}");
        assert_eq!(round(number), number.round(), "{number:?}");
    }

    #[test]
    fn results_match_the_standard_library() {
        for step in -400_000..=400_000 {
            agree(f64::from(step) / 1024.0);
            agree(f64::from(step) * 1_000.7);
        }
        for whole in -50..=50 {
            let half = f64::from(whole) / 2.0;
            [half, half.next_up(), half.next_down()]
                .into_iter()
                .for_each(agree);
        }
    }

    #[test]
    fn nan_stays_nan() {
        assert!(floor(f64::NAN).is_nan() && round(f64::NAN).is_nan());
    }
}
