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

/// The 80 % quantile of the normal distribution.
pub(super) const Z_80: f64 = 0.841_621_233_572_914_3;

/// Returns the trials per group with which Fisher's exact test distinguishes two shares with a
/// power of 80 %, at 5 % error. Uses the formula of Casagrande, Pike and Smith (1978). `None` when
/// the shares are equal.
pub fn trials_needed(a: f64, b: f64) -> Option<u64> {
    if a == b {
        return None;
    }
    let mean = f64::midpoint(a, b);
    let under_equality = (2.0 * mean * (1.0 - mean)).sqrt();
    let under_difference = (a * (1.0 - a) + b * (1.0 - b)).sqrt();
    let root = (Z_95 * under_equality + Z_80 * under_difference) / (a - b);
    let uncorrected = root * root;
    let correction = 1.0 + (1.0 + 4.0 / (uncorrected * (a - b).abs())).sqrt();
    Some((uncorrected * correction * correction / 4.0).ceil() as u64)
}

/// Returns the smallest difference of two shares around one half, in hundredths, that `trials`
/// trials per group detect with a power of 80 % by [`trials_needed`]. `None` if not even 0 against
/// 1 is detected.
pub fn detectable_difference(trials: u64) -> Option<f64> {
    let mut shares = (1..=50).map(|percent| f64::from(percent) / 100.0);
    let found = |half: &f64| trials_needed(0.5 - half, 0.5 + half).is_some_and(|n| n <= trials);
    shares.find(found).map(|half| 2.0 * half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::statistics::assert_close;

    #[test]
    fn trials_needed_give_fishers_test_its_power() {
        // The power of Fisher's test, summed over all tables in Python, is 0.82, 0.82, 0.90, 0.80.
        for (a, b, trials) in [
            (0.65, 0.10, 15),
            (0.79, 0.48, 43),
            (0.46, 0.02, 18),
            (0.54, 0.29, 68),
        ] {
            assert_eq!(trials_needed(a, b), Some(trials), "{a} against {b}");
        }
        assert_eq!(trials_needed(0.79, 0.77), Some(6833));
        assert_eq!(trials_needed(1.0, 0.0), Some(4));
        assert_eq!(trials_needed(0.5, 0.5), None);
    }

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
