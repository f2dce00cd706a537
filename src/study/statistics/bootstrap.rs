//! Intervals by resampling.

use super::{Interval, iqm, quantile};
use xcs::random::Stream;

/// How often the numbers are drawn anew.
const RESAMPLES: usize = 2_000;

/// The interquartile mean with its percentile bootstrap 95 % interval. `None` without numbers.
pub fn bootstrap_interval(numbers: &[f64], stream: &mut Stream) -> Option<Interval> {
    let value = iqm(numbers)?;
    let resampled: Vec<f64> = (0..RESAMPLES)
        .filter_map(|_| iqm(&resample(numbers, stream)))
        .collect();
    Some(Interval {
        value,
        low: quantile(&resampled, 0.025)?,
        high: quantile(&resampled, 0.975)?,
    })
}

fn resample(numbers: &[f64], stream: &mut Stream) -> Vec<f64> {
    let draw = |_| numbers[stream.below(numbers.len())];
    (0..numbers.len()).map(draw).collect()
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

    const SCIPY: (f64, f64) = (21.0, 34.23);
}
