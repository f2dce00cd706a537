//! The distribution of first optimal episodes (Figure 4 of the paper).

use super::layout::Plot;
use super::panels::Panels;
use crate::picture::chart::{Anchor, Axis, Chart, Line, label};
use crate::picture::svg::Element;

/// The number of bars.
const BARS: u32 = 18;

/// The number of trials whose policy was first optimal in each part of the episodes.
#[derive(Debug)]
pub(super) struct Firsts<'a> {
    panels: &'a Panels<'a>,
    /// Episodes of a bar.
    width: u32,
    /// The highest bar of all panels.
    most: u32,
}

impl<'a> Firsts<'a> {
    pub fn new(panels: &'a Panels<'a>) -> Self {
        let width = panels.episodes.div_ceil(BARS).max(1);
        let records = panels.records.iter();
        let bars = records.flat_map(|arm| counts(&arm.first_episodes(), width));
        Self {
            panels,
            width,
            most: bars.max().unwrap_or(0).max(1),
        }
    }
}

impl Plot for Firsts<'_> {
    fn labels(&self) -> [&'static str; 2] {
        ["first optimal episode", "trials"]
    }

    fn axes(&self, _: usize) -> [Axis; 2] {
        [
            Axis::linear(0.0, f64::from(self.panels.episodes)),
            Axis::linear(0.0, f64::from(self.most)),
        ]
    }

    fn is_apart(&self) -> bool {
        true
    }

    fn series(&self, chart: &Chart, place: usize, series: usize, line: Line) -> Vec<Element> {
        let Some(records) = self.panels.at(place, series) else {
            return Vec::new();
        };
        let width = f64::from(self.width);
        let firsts = records.first_episodes();
        let bars = (0..).zip(counts(&firsts, self.width));
        let bar = |(at, count): (u32, u32)| {
            let from = f64::from(at) * width;
            (count > 0).then(|| chart.bar(from, from + width, f64::from(count), line.colour))
        };
        let mut shapes: Vec<Element> = bars.filter_map(bar).collect();
        let solved = format!("{} of {}", firsts.len(), records.successes().trials);
        let at = (chart.left + chart.width, chart.top + 7.0);
        shapes.push(label(at, 9.0, Anchor::End, solved));
        shapes
    }

    fn behind(&self, _: &Chart, _: usize, _: usize, _: Line) -> Vec<Element> {
        Vec::new()
    }
}

/// Counts episodes, from 1, in bins of `width`.
fn counts(firsts: &[u32], width: u32) -> Vec<u32> {
    let mut counts = vec![0; BARS as usize];
    for first in firsts {
        // A forged file may have episodes that the study does not have.
        let bin = (first.saturating_sub(1) / width).min(BARS - 1);
        counts[bin as usize] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::counts;

    #[test]
    fn each_first_episode_is_in_the_bin_that_ends_after_it() {
        let counted = counts(&[1, 10, 10, 11, 180], 10);
        assert_eq!((counted[0], counted[1], counted[17]), (3, 1, 1));
        assert_eq!(counted.iter().sum::<u32>(), 5);
        assert_eq!(counts(&[u32::MAX], 10)[17], 1);
    }
}
