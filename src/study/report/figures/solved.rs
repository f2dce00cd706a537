//! Success curves: the share of trials that have found an optimal policy, by time.

use super::layout::{Plot, banded};
use super::panels::Panels;
use crate::picture::chart::{Axis, Chart, Line};
use crate::picture::svg::Element;
use crate::study::statistics::Interval;

/// The unit of time of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Time {
    Episodes,
    /// Steps in the environment, which compare methods with different step limits.
    Steps,
}

/// The share of solved trials with Wilson's 95 % band.
#[derive(Debug)]
pub(super) struct Solved<'a> {
    panels: &'a Panels<'a>,
    time: Time,
    axis: Axis,
}

impl<'a> Solved<'a> {
    pub fn new(panels: &'a Panels<'a>, time: Time) -> Self {
        let axis = match time {
            Time::Episodes => Axis::linear(0.0, f64::from(panels.episodes)),
            Time::Steps => {
                let firsts = panels.records.iter().flat_map(|arm| arm.first_env_steps());
                let ends = panels.records.iter().map(|arm| arm.most_steps() as f64);
                let last = ends.fold(1.0, f64::max);
                Axis::logarithmic(firsts.fold(last, f64::min), last)
            }
        };
        Self { panels, time, axis }
    }

    /// Returns the corners of the low, the high and the middle line of a series; none without trials.
    fn stairs(&self, place: usize, series: usize) -> Option<[Vec<(f64, f64)>; 3]> {
        let records = self.panels.at(place, series)?;
        let (firsts, end) = match self.time {
            Time::Episodes => {
                let firsts = records.first_episodes().into_iter().map(f64::from);
                (firsts.collect(), f64::from(self.panels.episodes))
            }
            Time::Steps => {
                let mut firsts: Vec<f64> = records.first_env_steps().collect();
                firsts.sort_by(f64::total_cmp);
                (firsts, records.most_steps() as f64)
            }
        };
        let steps = records.solved_by(&firsts);
        let lines: [fn(&Interval) -> f64; 3] = [|one| one.low, |one| one.high, |one| one.value];
        Some(lines.map(|line| staircase(&steps, end, line)))
    }
}

impl Plot for Solved<'_> {
    fn labels(&self) -> [&'static str; 2] {
        let time = match self.time {
            Time::Episodes => "episode",
            Time::Steps => "steps in the environment",
        };
        [time, "solved trials (%)"]
    }

    fn axes(&self, _: usize) -> [Axis; 2] {
        [self.axis, Axis::linear(0.0, 1.0)]
    }

    fn y_number(&self) -> fn(f64) -> String {
        |share| format!("{:.0}", 100.0 * share)
    }

    fn series(&self, chart: &Chart, place: usize, series: usize, line: Line) -> Vec<Element> {
        let stairs = self.stairs(place, series);
        stairs.map_or(Vec::new(), |stairs| banded(chart, &stairs, line))
    }

    fn behind(&self, chart: &Chart, place: usize, series: usize, line: Line) -> Vec<Element> {
        let stairs = self.stairs(place, series).into_iter();
        stairs
            .map(|[_, _, curve]| chart.curve(&curve, line))
            .collect()
    }
}

/// Returns the corners of a staircase through the steps, up to an end.
fn staircase(
    steps: &[(f64, Interval)],
    end: f64,
    share: impl Fn(&Interval) -> f64,
) -> Vec<(f64, f64)> {
    let mut corners: Vec<(f64, f64)> = Vec::new();
    for (at, interval) in steps {
        corners.extend(corners.last().map(|&(_, before)| (*at, before)));
        corners.push((*at, share(interval)));
    }
    corners.extend(corners.last().map(|&(_, last)| (end, last)));
    corners
}
