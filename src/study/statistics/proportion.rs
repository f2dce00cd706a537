//! Proportions of successes.

use super::{Interval, Z_95};

/// A number of successes in a number of trials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Proportion {
    /// Trials that succeeded.
    pub successes: u64,
    /// All trials.
    pub trials: u64,
}

impl Proportion {
    /// Returns `successes` in `trials` trials.
    pub const fn new(successes: u64, trials: u64) -> Self {
        Self { successes, trials }
    }

    /// Returns the share of successes; 0 without trials.
    pub fn share(self) -> f64 {
        match self.trials {
            0 => 0.0,
            trials => self.successes as f64 / trials as f64,
        }
    }

    /// Returns Wilson's 95 % interval of the share (1927), without continuity correction; 0 to 1
    /// without trials.
    pub fn wilson(self) -> Interval {
        let value = self.share();
        if self.trials == 0 {
            return Interval {
                value,
                low: 0.0,
                high: 1.0,
            };
        }
        let n = self.trials as f64;
        let z2 = Z_95 * Z_95;
        let centre = value + z2 / (2.0 * n);
        let half = Z_95 * (value * (1.0 - value) / n + z2 / (4.0 * n * n)).sqrt();
        let scale = 1.0 + z2 / n;
        // Rounding must not push a limit past what was observed.
        Interval {
            value,
            low: ((centre - half) / scale).clamp(0.0, value),
            high: ((centre + half) / scale).clamp(value, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::statistics::assert_close;

    #[test]
    fn wilson_intervals_as_in_scipy() {
        // scipy 1.17.1: binomtest(k, n).proportion_ci(method="wilson")
        for (successes, trials, low, high) in WILSON {
            let interval = Proportion::new(successes, trials).wilson();
            assert_close(interval.low, low);
            assert_close(interval.high, high);
        }
    }

    const WILSON: [(u64, u64, f64, f64); 4] = [
        (79, 100, 0.7002003116591013, 0.858343459380847),
        (0, 100, 0.0, 0.03699349820698568),
        (100, 100, 0.9630065017930143, 1.0),
        (1, 3, 0.06149194472039626, 0.7923403991979523),
    ];

    #[test]
    fn the_interval_is_0_to_1_without_trials() {
        let none = Proportion::new(0, 0).wilson();
        assert_eq!((none.low, none.high), (0.0, 1.0));
    }
}
