//! Bootstrap confidence intervals.

use super::{Interval, iqm, quantile};
use xcs::random::Stream;

/// Number of resamples.
const RESAMPLES: usize = 2_000;

/// Returns the interquartile mean with its percentile bootstrap 95 % interval. `None` without
/// numbers.
pub fn bootstrap_interval(numbers: &[f64], stream: &mut Stream) -> Option<Interval> {
    let value = iqm(numbers)?;
    let mut draws = Draws::of(numbers);
    let resampled: Vec<f64> = (0..RESAMPLES).map(|_| draws.draw(stream)).collect();
    Some(Interval {
        value,
        low: quantile(&resampled, 0.025)?,
        high: quantile(&resampled, 0.975)?,
    })
}

/// Numbers to resample. They are sorted once, and a resample counts how often each number is drawn.
/// This avoids sorting a million numbers for each resample.
struct Draws {
    sorted: Vec<f64>,
    /// The index of each number in `sorted`.
    ranks: Vec<u32>,
    times: Vec<u32>,
}

impl Draws {
    fn of(numbers: &[f64]) -> Self {
        let mut order: Vec<u32> = (0..).take(numbers.len()).collect();
        order.sort_by(|a, b| numbers[*a as usize].total_cmp(&numbers[*b as usize]));
        let mut ranks = vec![0; numbers.len()];
        for (rank, number) in (0..).zip(&order) {
            ranks[*number as usize] = rank;
        }
        Self {
            sorted: order
                .iter()
                .map(|number| numbers[*number as usize])
                .collect(),
            times: vec![0; numbers.len()],
            ranks,
        }
    }

    /// Returns the interquartile mean of a resample of the same size, drawn with replacement.
    fn draw(&mut self, stream: &mut Stream) -> f64 {
        let count = self.sorted.len();
        self.times.fill(0);
        for _ in 0..count {
            self.times[self.ranks[stream.below(count)] as usize] += 1;
        }
        let cut = count / 4;
        let drawn = self.sorted.iter().zip(&self.times);
        let drawn = drawn.flat_map(|(number, times)| std::iter::repeat_n(*number, *times as usize));
        let left = count - 2 * cut;
        drawn.skip(cut).take(left).sum::<f64>() / left as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::streams::StreamName;

    #[test]
    fn close_to_scipy_and_the_same_every_time() {
        let numbers: Vec<f64> = (1..=50).map(|i| f64::from(i * i % 53)).collect();
        let interval = || bootstrap_interval(&numbers, &mut Stream::new(1, StreamName::Bootstrap));
        let once = interval().unwrap();
        assert_eq!(Some(once), interval());
        // scipy 1.17.1: bootstrap(([i * i % 53 for i in range(1, 51)],), lambda x, axis:
        // trim_mean(x, 0.25, axis=axis), method="percentile", n_resamples=100_000)
        let (low, high) = SCIPY;
        assert!(
            (once.low - low).abs() < 0.8 && (once.high - high).abs() < 0.8,
            "{once:?}"
        );
    }

    #[test]
    fn counted_draws_are_the_same_as_drawn_and_sorted_numbers() {
        for count in [1, 2, 3, 7, 50, 101] {
            let numbers: Vec<f64> = (0..count).map(|i| f64::from(i * 7 % 13) / 3.0).collect();
            let (mut a, mut b) = [(); 2]
                .map(|()| Stream::new(3, StreamName::Bootstrap))
                .into();
            let mut draws = Draws::of(&numbers);
            for _ in 0..20 {
                let drawn: Vec<f64> = numbers
                    .iter()
                    .map(|_| numbers[a.below(numbers.len())])
                    .collect();
                assert_eq!(Some(draws.draw(&mut b)), iqm(&drawn), "{count} numbers");
            }
        }
    }

    const SCIPY: (f64, f64) = (21.0, 34.23);
}
