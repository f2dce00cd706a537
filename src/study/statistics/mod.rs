//! Statistics of finished trials, independent of mazes and learners.
//!
//! All functions are deterministic. Resampling takes a random stream as an argument.

mod bootstrap;
mod holm;
mod iqm;
mod paired;
mod power;
mod proportion;

use statrs::distribution::{ContinuousCDF, StudentsT};

pub use bootstrap::bootstrap_interval;
pub use holm::holm;
pub use iqm::{iqm, quantile};
pub use paired::Pairs;
pub use power::{ALPHA, SignTest};
pub use proportion::Proportion;

/// The normal deviate with 2.5 % on either side.
pub const Z_95: f64 = 1.959_963_984_540_054;

/// The most degrees of freedom for which the quantile of Student's distribution is computed; `statrs` is less
/// exact beyond.
const MOST_EXACT: f64 = 10_000.0;

/// Returns the quantile of Student's distribution with 2.5 % on either side, for the mean of `count` numbers; 0 for
/// fewer than two numbers, whose variance is unknown.
pub fn t_95(count: u64) -> f64 {
    let freedom = count.saturating_sub(1) as f64;
    if freedom > MOST_EXACT {
        // The first term of the expansion around the normal quantile; the others are below 1e-8.
        return Z_95 + (Z_95.powi(3) + Z_95) / (4.0 * freedom);
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(0.0, |student| student.inverse_cdf(0.975))
}

/// An estimate with its lower and upper 95 % limits.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// The lower limit.
    pub low: f64,
    /// The upper limit.
    pub high: f64,
}

impl Interval {
    /// Rounds all numbers to six decimals.
    pub fn rounded(self) -> Self {
        Self {
            value: rounded(self.value),
            low: rounded(self.low),
            high: rounded(self.high),
        }
    }
}

/// Rounds to six decimals. The last digits of logarithms differ between machines.
pub fn rounded(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}

#[cfg(test)]
fn assert_close(actual: f64, expected: f64) {
    let is_close = (actual - expected).abs() < 1e-9;
    assert!(is_close, "{actual} is not {expected}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_as_in_scipy() {
        // scipy 1.17.1: t.ppf(0.975, n - 1)
        for (count, t) in [(2, 12.706_204_736), (3, 4.302_652_730), (30, 2.045_229_642)] {
            assert!((t_95(count) - t).abs() < 1e-8, "{count}: {}", t_95(count));
        }
        let many = [(10_001, 1.960_201_239), (1_000_001, 1.959_966_357)];
        assert!(
            many.iter()
                .all(|(count, t)| (t_95(*count) - t).abs() < 1e-8)
        );
        assert_eq!([0, 1].map(t_95), [0.0; 2]);
    }
}
