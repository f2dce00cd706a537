//! A small chart for the terminal.

/// Bars, the lowest first.
const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
/// The most bars of a chart. This leaves room for a label in 80 columns.
const MOST: usize = 48;

/// Draws numbers as bars from 0 to the greatest number. With many numbers, each bar is the mean of
/// several. Returns an empty string without numbers.
pub fn sparkline(numbers: &[u32]) -> String {
    let bars = numbers.len().min(MOST);
    let means: Vec<f64> = (0..bars)
        .map(|bar| mean(part(numbers, bar, bars)))
        .collect();
    let most = means.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let level = |mean: f64| (mean / most * (BARS.len() - 1) as f64).round() as usize;
    means.into_iter().map(|mean| BARS[level(mean)]).collect()
}

/// Draws a cross below each bar of a [`sparkline`] with an episode that is marked.
pub fn marks(marked: &[bool]) -> String {
    let bars = marked.len().min(MOST);
    let mark = |bar: usize| match part(marked, bar, bars).contains(&true) {
        true => '×',
        false => ' ',
    };
    let marks: String = (0..bars).map(mark).collect();
    marks.trim_end().to_owned()
}

/// Returns part `number` of `parts` nearly equal parts.
fn part<T>(all: &[T], number: usize, parts: usize) -> &[T] {
    let cut = |at: usize| at * all.len() / parts;
    &all[cut(number)..cut(number + 1)]
}

/// Returns the mean of numbers; 0 if there are none.
pub fn mean(numbers: &[u32]) -> f64 {
    let sum: u64 = numbers.iter().copied().map(u64::from).sum();
    sum as f64 / numbers.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_with_a_marked_episode_has_a_cross_below_it() {
        assert_eq!(marks(&[true, false, true, false]), "× ×");
        let mut many = [false; 96];
        many[95] = true;
        assert_eq!(marks(&many), " ".repeat(47) + "×");
    }

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
