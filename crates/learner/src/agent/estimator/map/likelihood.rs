//! Likelihoods of long episodes, which exceed the range of an `f64`.

/// A product of many small numbers: `mantissa * 2^exponent`, with a mantissa from 0.5 to 1.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Likelihood {
    exponent: i64,
    mantissa: f64,
}

impl Likelihood {
    /// The likelihood 1.
    pub const ONE: Self = Self {
        exponent: 1,
        mantissa: 0.5,
    };

    /// Multiplies by a non-negative number.
    pub fn times(self, factor: f64) -> Self {
        let (mantissa, exponent) = libm::frexp(self.mantissa * factor);
        match mantissa > 0.0 {
            true => Self {
                exponent: self.exponent + i64::from(exponent),
                mantissa,
            },
            false => Self {
                exponent: i64::MIN,
                mantissa: 0.0,
            },
        }
    }

    /// Multiplies by two, `times` times.
    pub fn doubled(self, times: usize) -> Self {
        let exponent = self.exponent.saturating_add(times as i64);
        match self.mantissa > 0.0 {
            true => Self { exponent, ..self },
            false => self,
        }
    }

    /// Multiplies by another likelihood.
    pub fn and(self, other: Self) -> Self {
        if self.mantissa == 0.0 || other.mantissa == 0.0 {
            return self.times(0.0);
        }
        let product = self.times(other.mantissa);
        Self {
            exponent: product.exponent + other.exponent,
            ..product
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubling_more_often_than_a_float_can_hold_is_the_same_as_one_by_one() {
        let small = Likelihood::ONE.times(0.3);
        let one_by_one = (0..2_000).fold(small, |product, _| product.times(2.0));
        assert_eq!(small.doubled(2_000), one_by_one);
        assert_ne!(small.doubled(1_999), one_by_one, "control");
        let never = Likelihood::ONE.times(0.0);
        assert_eq!(never.doubled(2_000), never);
    }
}
