//! Statistics of finished trials, independent of mazes and learners.
//!
//! All functions are deterministic. Resampling takes a random stream as an argument.

mod bootstrap;
mod holm;
mod iqm;
mod paired;
mod proportion;

pub use bootstrap::bootstrap_interval;
pub use holm::holm;
pub use iqm::{iqm, quantile};
pub use paired::{Pairs, detectable_share};
pub use proportion::{Proportion, detectable_difference, trials_needed};

/// The normal deviate with 2.5 % on either side.
pub const Z_95: f64 = 1.959_963_984_540_054;

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
