//! Robust summary statistics.

/// Returns the interquartile mean: the mean without the lowest and the highest quarter of the
/// numbers, rounded down. `None` without numbers.
pub fn iqm(numbers: &[f64]) -> Option<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let cut = sorted.len() / 4;
    let middle = &sorted[cut..sorted.len() - cut];
    (!middle.is_empty()).then(|| middle.iter().sum::<f64>() / middle.len() as f64)
}

/// Returns the quantile `q`, interpolated linearly between neighbours. `None` without numbers.
pub fn quantile(numbers: &[f64], q: f64) -> Option<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = q * (sorted.len().checked_sub(1)?) as f64;
    let (below, above) = (
        sorted[place.floor() as usize],
        sorted[place.ceil() as usize],
    );
    Some(below + (above - below) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_the_middle_half_as_in_scipy() {
        // scipy 1.17.1: trim_mean(x, 0.25)
        let numbers = [12.0, 7.0, 3.0, 100.0, 8.0, 9.0, 1.0, 15.0, 4.0, 6.0];
        assert_eq!(iqm(&numbers), Some(46.0 / 6.0));
        assert_eq!(iqm(&[3.0]), Some(3.0));
        assert_eq!(iqm(&[]), None);
    }

    #[test]
    fn quantiles_lie_between_neighbours() {
        assert_eq!(quantile(&[4.0, 1.0, 2.0, 3.0], 0.5), Some(2.5));
        assert_eq!(quantile(&[1.0, 2.0], 1.0), Some(2.0));
        assert_eq!(quantile(&[], 0.5), None);
    }
}
