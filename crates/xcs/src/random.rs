//! Portable random numbers: the same on every machine and in every version.
//!
//! One root seed gives any number of independent streams, so disabling one consumer does not affect
//! the others. Only `next_u64` is taken from the generator (PCG XSL RR 128/64, whose output is
//! documented as portable). All sampling is implemented here, because samplers in libraries change
//! their results between releases.

use rand::Rng;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// A stream of random numbers; its whole state can be saved and restored.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Pcg64")]
pub struct Stream(Pcg64);

/// A saved state that would repeat one number forever.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a saved random stream is degenerate: it would repeat one number")]
pub struct DegenerateStream;

impl TryFrom<Pcg64> for Stream {
    type Error = DegenerateStream;

    /// Rejects degenerate generators. No seed leads to one, but a damaged file may contain one.
    fn try_from(generator: Pcg64) -> Result<Self, DegenerateStream> {
        let mut ahead = generator.clone();
        let first = ahead.next_u64();
        let moves = (0..8).any(|_| ahead.next_u64() != first);
        moves.then_some(Self(generator)).ok_or(DegenerateStream)
    }
}

impl Stream {
    /// Creates stream number `which` under the root `seed`. Use an enum with a number for each
    /// consumer to keep the streams apart: `Stream::new(7, Draws::Noise)`, or simply
    /// `Stream::new(7, 1_u64)`.
    pub fn new(seed: u64, which: impl Into<u64>) -> Self {
        let mut state = seed;
        let mut word = || u128::from(splitmix64(&mut state));
        let start = word() << 64 | word();
        Self(Pcg64::new(start, u128::from(which.into())))
    }

    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Returns an unbiased integer in `0..n` (Lemire's multiplication with rejection). `n` is at
    /// least 1.
    pub fn below(&mut self, n: usize) -> usize {
        let n = n as u64;
        loop {
            let product = u128::from(self.bits()) * u128::from(n);
            if product as u64 >= n.wrapping_neg() % n {
                return (product >> 64) as usize;
            }
        }
    }

    /// Returns a number in `[0, 1)` with 53 random bits.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// Returns true with the given probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Returns a deviate of mean 0 and standard deviation 1: the centred sum of twelve uniform
    /// 16-bit numbers (Irwin-Hall). The absolute value is at most 6. Uses no platform-dependent
    /// functions.
    pub fn normal(&mut self) -> f64 {
        // Each word is added as two lanes of 32 bits. Twelve 16-bit numbers cannot overflow a lane.
        const LANES: u64 = 0x0000_ffff_0000_ffff;
        let lanes: u64 = (0..3)
            .map(|_| self.bits())
            .map(|b| (b & LANES) + (b >> 16 & LANES))
            .sum();
        let sum = (lanes & 0xffff_ffff) + (lanes >> 32);
        // Twelve numbers of mean 32767.5 each; the variance of each is (65536^2 - 1) / 12.
        (sum as f64 - 12.0 * 32_767.5) / 65_536.0
    }

    /// Returns a uniformly chosen element of `items`; `None` if there is none.
    pub fn choose<'a, T>(&mut self, items: &'a [T]) -> Option<&'a T> {
        if items.is_empty() {
            None
        } else {
            items.get(self.below(items.len()))
        }
    }
}

/// Returns the root seed of replicate `number` of a study. It is below 2^53, so that every JSON or
/// CSV reader parses it exactly.
pub fn replicate_seed(root: u64, number: u64) -> u64 {
    let mut state = root;
    let mut state = splitmix64(&mut state).wrapping_add(number);
    splitmix64(&mut state) >> 11
}

/// Returns the next word of the SplitMix64 sequence (Steele, Lea and Flood 2014).
fn splitmix64(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn below_reaches_every_number_equally_often() {
        let mut stream = Stream::new(1, 0_u64);
        let mut counts = [0; 7];
        (0..70_000).for_each(|_| counts[stream.below(7)] += 1);
        assert!(
            counts.iter().all(|c| (9_600..10_400).contains(c)),
            "{counts:?}"
        );
    }

    #[test]
    fn unit_stays_below_one() {
        let mut stream = Stream::new(2, 0_u64);
        assert!((0..10_000).all(|_| (0.0..1.0).contains(&stream.unit())));
    }

    #[test]
    fn normal_has_mean_zero_and_deviation_one() {
        let mut stream = Stream::new(3, 4_u64);
        let draws: Vec<f64> = (0..100_000).map(|_| stream.normal()).collect();
        let mean = draws.iter().sum::<f64>() / 1e5;
        let variance = draws.iter().map(|d| d * d).sum::<f64>() / 1e5;
        assert!(
            mean.abs() < 0.02 && (variance - 1.0).abs() < 0.02,
            "{mean} {variance}"
        );
    }

    #[test]
    fn replicates_of_neighbouring_roots_share_no_seed() {
        let mut seeds: Vec<u64> = (0..50)
            .flat_map(|root| (1..=200).map(move |number| replicate_seed(root, number)))
            .collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 10_000);
        assert!(seeds.iter().all(|seed| *seed < 1 << 53));
    }

    #[test]
    fn numbers_and_seeds_give_different_streams() {
        let first = |seed, which: u64| Stream::new(seed, which).bits();
        assert_ne!(first(1, 0), first(1, 2));
        assert_ne!(first(0, 0), first(1, 0));
    }
}
