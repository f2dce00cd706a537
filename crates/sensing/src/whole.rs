//! Whole numbers near a number.
//!
//! The same bits as `f64::floor` and `f64::round`, which on the baseline of x86-64 are calls of a
//! function, for numbers as large as coordinates are. Each beam of the lidar needs several.

/// Adding and subtracting it leaves no digits behind the point.
const SHIFT: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52

/// The largest whole number that is not above `number`, whose size is below 2^51.
pub fn floor(number: f64) -> f64 {
    let near = (number + SHIFT) - SHIFT;
    if near > number { near - 1.0 } else { near }
}

/// The nearest whole number to `number`, whose size is below 2^51; a half goes away from zero.
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
    fn they_are_those_of_the_standard_library() {
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
    fn no_number_stays_none() {
        assert!(floor(f64::NAN).is_nan() && round(f64::NAN).is_nan());
    }
}
