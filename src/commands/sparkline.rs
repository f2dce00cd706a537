//! A small curve for the terminal.

/// Bars from the lowest to the highest.
const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
/// The most bars of a curve, which leaves room for a label in 80 columns.
const MOST: usize = 48;

/// The numbers as bars from 0 to the greatest of them; of many numbers, each bar is the mean of
/// several. Empty without numbers.
pub fn sparkline(numbers: &[u32]) -> String {
    let bars = numbers.len().min(MOST);
    let means: Vec<f64> = (0..bars)
        .map(|bar| mean(part(numbers, bar, bars)))
        .collect();
    let most = means.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let level = |mean: f64| (mean / most * (BARS.len() - 1) as f64).round() as usize;
    means.into_iter().map(|mean| BARS[level(mean)]).collect()
}

/// Part `number` of so many that are as equal as can be.
fn part(numbers: &[u32], number: usize, parts: usize) -> &[u32] {
    let cut = |at: usize| at * numbers.len() / parts;
    &numbers[cut(number)..cut(number + 1)]
}

/// The mean of some numbers; 0 of none.
pub fn mean(numbers: &[u32]) -> f64 {
    let sum: u64 = numbers.iter().copied().map(u64::from).sum();
    sum as f64 / numbers.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_falls_as_its_numbers_do_and_never_grows_too_wide() {
        assert_eq!(sparkline(&[7, 3, 0]), "█▄▁");
        assert_eq!(sparkline(&[]), "");
        assert_eq!(sparkline(&[0, 0]), "▁▁");
        let many: Vec<u32> = (0..1000).collect();
        let curve: Vec<char> = sparkline(&many).chars().collect();
        assert_eq!((curve.len(), curve[0], curve[47]), (48, '▁', '█'));
    }
}
