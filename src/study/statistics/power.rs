//! The power of the test that decides a comparison: the exact sign test of pairs, after Holm's correction.

use statrs::distribution::{Binomial, ContinuousCDF, Discrete, DiscreteCDF, Normal};

/// The accepted probability of a type I error.
pub const ALPHA: f64 = 0.05;
/// The wanted probability to detect a difference.
const POWER: f64 = 0.8;
/// The 80 % quantile of the normal distribution.
const Z_80: f64 = 0.841_621_233_572_914_3;
/// The largest number of pairs whose power is summed exactly. Above it, the normal approximation is within 3 %.
const MOST_EXACT: u64 = 2_000;
/// Counts that are farther from their mean than this many standard deviations are neglected.
const FAR: f64 = 8.0;

/// The exact two-sided sign test of one of several comparisons. For binary outcomes, this is McNemar's test.
#[derive(Debug, Clone, Copy)]
pub struct SignTest {
    /// The p below which the test decides.
    level: f64,
}

impl SignTest {
    /// Returns the test of one of so many comparisons, at the strictest level of Holm's correction. A comparison
    /// that this level decides is decided whatever the others show.
    pub fn of(comparisons: usize) -> Self {
        Self {
            level: ALPHA / comparisons.max(1) as f64,
        }
    }

    /// Returns the probability that the test decides, if the first is better in this share of pairs, and
    /// worse in that one.
    pub fn power(self, pairs: u64, better: f64, worse: f64) -> f64 {
        let different = (better + worse).min(1.0);
        if different <= 0.0 {
            return 0.0;
        }
        let count = binomial(different, pairs);
        let mean = pairs as f64 * different;
        let far = FAR * (mean * (1.0 - different)).sqrt() + 1.0;
        let first = (mean - far).max(0.0) as u64;
        let last = ((mean + far).ceil() as u64).min(pairs);
        let mut fewest = None;
        let decided = (first..=last).map(|differing| {
            fewest = self.most_exceptions(differing, fewest);
            let Some(exceptions) = fewest else {
                return 0.0;
            };
            let ahead = binomial(better / (better + worse), differing);
            let behind = ahead.cdf(exceptions);
            let ahead = ahead.sf(differing - exceptions - 1);
            count.pmf(differing) * (behind + ahead)
        });
        decided.sum::<f64>().min(1.0)
    }

    /// Returns how many of the pairs that differ may differ the other way, so that the test still decides. `None` if
    /// it never does. `at_least` is the number for fewer pairs.
    fn most_exceptions(self, differing: u64, at_least: Option<u64>) -> Option<u64> {
        let coin = binomial(0.5, differing);
        let decides = |count: u64| 2.0 * coin.cdf(count) < self.level;
        let (mut low, mut high) = (at_least.map_or(0, |least| least + 1), differing / 2 + 1);
        while low < high {
            let middle = u64::midpoint(low, high);
            if decides(middle) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low.checked_sub(1)
    }

    /// Returns the smallest share of pairs, above one half, that must be better so that so many pairs decide
    /// it with a power of 80 %. `None` if no share is large enough.
    pub fn detectable_share(self, pairs: u64) -> Option<f64> {
        let power = |share: f64| self.power_of(pairs, share, 1.0 - share);
        first_percent(51, |percent| power(percent) >= POWER)
    }

    /// Returns the smallest difference of two shares around one half that so many pairs decide with a power of
    /// 80 %, if the two outcomes of a pair are independent. `None` if not even 0 against 1 is decided.
    pub fn detectable_difference(self, pairs: u64) -> Option<f64> {
        let power = |half: f64| {
            let (high, low) = (0.5 + half, 0.5 - half);
            self.power_of(pairs, high * high, low * low)
        };
        first_percent(1, |half| half <= 0.5 && power(half) >= POWER).map(|half| 2.0 * half)
    }

    /// Returns the fewest pairs that decide with a power of 80 % that the first is better in one share of pairs and
    /// worse in another. `None` if the shares are equal.
    pub fn pairs_needed(self, better: f64, worse: f64) -> Option<u64> {
        if better == worse {
            return None;
        }
        let approximate = self.approximate_pairs(better, worse).ceil() as u64;
        if approximate > MOST_EXACT {
            return Some(approximate);
        }
        let is_enough = |pairs| self.power(pairs, better, worse) >= POWER;
        let (mut low, mut high) = (0, approximate.max(1));
        while !is_enough(high) {
            (low, high) = (high, high + high / 4 + 8);
        }
        while high - low > 1 {
            let middle = u64::midpoint(low, high);
            if is_enough(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(high)
    }

    /// Returns the power, by the normal approximation for many pairs.
    fn power_of(self, pairs: u64, better: f64, worse: f64) -> f64 {
        if pairs <= MOST_EXACT {
            return self.power(pairs, better, worse);
        }
        if better != worse && self.approximate_pairs(better, worse) <= pairs as f64 {
            POWER
        } else {
            0.0
        }
    }

    /// Returns the pairs that are needed by the normal approximation of Connor (1987).
    fn approximate_pairs(self, better: f64, worse: f64) -> f64 {
        let (different, by) = (better + worse, better - worse);
        let z = Normal::standard().inverse_cdf(1.0 - self.level / 2.0);
        let root = z * different.sqrt() + Z_80 * (different - by * by).max(0.0).sqrt();
        (root / by).powi(2)
    }
}

/// Returns the first hundredth from `first` on up to 1 for which `is_enough` holds; it must hold for all larger
/// ones.
fn first_percent(first: u32, is_enough: impl Fn(f64) -> bool) -> Option<f64> {
    let mut percents = (first..=100).map(|percent| f64::from(percent) / 100.0);
    percents.find(|&percent| is_enough(percent))
}

fn binomial(share: f64, count: u64) -> Binomial {
    Binomial::new(share.clamp(0.0, 1.0), count).expect("a share is a probability")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Python, in exact fractions, summed over all counts of pairs that differ.
    #[test]
    fn the_power_is_that_of_all_outcomes() {
        for (comparisons, power) in [(1, 0.849_0), (9, 0.583_0), (27, 0.438_3)] {
            let found = SignTest::of(comparisons).power(100, 0.61 * 0.61, 0.39 * 0.39);
            assert!((found - power).abs() < 1e-4, "{comparisons}: {found}");
        }
        assert_eq!(
            SignTest::of(1).power(5, 1.0, 0.0),
            0.0,
            "6 to 0 is the least that decides"
        );
        assert_eq!(SignTest::of(1).power(6, 1.0, 0.0), 1.0);
        assert_eq!(SignTest::of(3).power(6, 1.0, 0.0), 0.0, "p = 3 / 32");
        assert_eq!(SignTest::of(1).power(100, 0.0, 0.0), 0.0);
    }

    #[test]
    fn a_larger_correction_detects_less() {
        let detectable = |comparisons| {
            let test = SignTest::of(comparisons);
            let difference = test
                .detectable_difference(100)
                .map(|by| (100.0 * by).round());
            (test.detectable_share(100), difference)
        };
        assert_eq!(detectable(1), (Some(0.65), Some(22.0)));
        assert_eq!(detectable(9), (Some(0.69), Some(28.0)));
        assert_eq!(detectable(27), (Some(0.70), Some(30.0)));
        let few = SignTest::of(3);
        assert_eq!(
            (few.detectable_share(6), few.detectable_difference(6)),
            (None, None)
        );
    }

    #[test]
    fn the_needed_pairs_have_the_power_and_fewer_do_not() {
        for (comparisons, better, worse) in [
            (1, 0.3, 0.1),
            (9, 0.37, 0.15),
            (27, 0.9, 0.0),
            (4, 0.1, 0.2),
        ] {
            let test = SignTest::of(comparisons);
            let pairs = test.pairs_needed(better, worse).unwrap();
            let [enough, fewer] = [pairs, pairs - 1].map(|pairs| test.power(pairs, better, worse));
            assert!(
                enough >= POWER && fewer < POWER,
                "{pairs}: {enough} {fewer}"
            );
        }
        assert_eq!(SignTest::of(1).pairs_needed(0.2, 0.2), None);
        let many = SignTest::of(1).pairs_needed(0.21, 0.20).unwrap();
        assert!((31_000..33_500).contains(&many), "{many}");
    }

    #[test]
    fn the_approximation_for_many_pairs_continues_the_sum() {
        let test = SignTest::of(9);
        for by in [0.06, 0.1] {
            let (better, worse) = (0.25 + by / 2.0, 0.25 - by / 2.0);
            let approximate = test.approximate_pairs(better, worse);
            let power = test.power(approximate as u64, better, worse);
            assert!((power - POWER).abs() < 0.03, "{approximate}: {power}");
        }
    }
}
