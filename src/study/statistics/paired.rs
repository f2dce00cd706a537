//! Paired comparison of trials with the same seed.

use std::cmp::Ordering;

use statrs::distribution::{Binomial, DiscreteCDF};

use super::{Interval, Z_95};

/// Counts of pairs by which of the two was better. Pairs without a difference carry no information.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Pairs {
    /// Pairs in which the first was better.
    pub better: u64,
    /// Pairs in which the second was better.
    pub worse: u64,
    /// Pairs without a difference.
    pub equal: u64,
}

impl Pairs {
    /// Counts a pair.
    pub fn add(&mut self, first_against_second: Ordering) {
        *match first_against_second {
            Ordering::Greater => &mut self.better,
            Ordering::Less => &mut self.worse,
            Ordering::Equal => &mut self.equal,
        } += 1;
    }

    /// Returns the number of all pairs.
    pub fn count(self) -> u64 {
        self.better + self.worse + self.equal
    }

    /// Returns the exact two-sided p that either of the two is better equally often: the sign test.
    /// For binary outcomes this is McNemar's test (1947).
    pub fn p(self) -> f64 {
        let (fewer, different) = (self.better.min(self.worse), self.better + self.worse);
        let coin = Binomial::new(0.5, different).expect("one half is a probability");
        (2.0 * coin.cdf(fewer)).min(1.0)
    }

    /// Returns the share of good outcomes in the first minus that in the second, with its 95 %
    /// interval. A pair differs when exactly one of its outcomes is good. The interval is
    /// Wald's for paired differences with the correction of Agresti and Min (2005).
    pub fn difference(self) -> Interval {
        let [better, worse] = [self.better, self.worse].map(|count| count as f64);
        let n = self.count().max(1) as f64;
        // Half an observation is added to each of the four cells.
        let (b, c, m) = (better + 0.5, worse + 0.5, n + 2.0);
        let centre = (b - c) / m;
        let half = Z_95 * (b + c - (b - c) * (b - c) / m).sqrt() / m;
        let value = (better - worse) / n;
        Interval {
            value,
            low: (centre - half).clamp(-1.0, value),
            high: (centre + half).clamp(value, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(better: u64, worse: u64, equal: u64) -> Pairs {
        Pairs {
            better,
            worse,
            equal,
        }
    }

    #[test]
    fn the_sign_test_as_in_scipy() {
        // scipy 1.17.1: binomtest(k, n).pvalue
        for (better, worse, p) in SCIPY {
            for pairs in [pairs(better, worse, 3), pairs(worse, better, 0)] {
                assert!(
                    (pairs.p() - p).abs() < 1e-9 * p.max(1e-3),
                    "{pairs:?}: {}",
                    pairs.p()
                );
            }
        }
    }

    const SCIPY: [(u64, u64, f64); 5] = [
        (0, 0, 1.0),
        (6, 0, 0.03125),
        (15, 5, 0.041_389_465_332_031_25),
        (7, 7, 1.0),
        (300, 400, 1.784_763_144_856_244e-4),
    ];

    /// By hand: half an observation in each cell makes 15.5 and 5.5 of 102. The difference is
    /// 0.098039. Its standard error is the root of 21 - 100/102, divided by 102.
    #[test]
    fn the_difference_of_pairs_with_the_interval_of_agresti_and_min() {
        let Interval { value, low, high } = pairs(15, 5, 80).difference();
        assert_eq!(value, 0.1);
        assert!(
            (low - 0.012_064).abs() < 1e-5 && (high - 0.184_015).abs() < 1e-5,
            "{low} {high}"
        );
        let all = pairs(10, 0, 0).difference();
        assert!(
            all.value == 1.0 && all.high == 1.0 && all.low > 0.5,
            "{all:?}"
        );
        assert_eq!(pairs(0, 0, 0).difference().value, 0.0);
    }
}
