//! Learning curves: the steps of each episode.

use super::layout::{Plot, banded};
use super::panels::Panels;
use crate::picture::chart::{Axis, Chart, Line};
use crate::picture::svg::Element;
use crate::study::analysis::learning::CurvePoint;

/// The mean steps of each episode with their interval.
#[derive(Debug)]
pub(super) struct Episodes<'a> {
    panels: &'a Panels<'a>,
    /// By arm.
    curves: &'a [Vec<CurvePoint>],
}

impl<'a> Episodes<'a> {
    /// Creates the plot of these panels from the curve of each arm.
    pub fn new(panels: &'a Panels<'a>, curves: &'a [Vec<CurvePoint>]) -> Self {
        Self { panels, curves }
    }

    fn curve(&self, place: usize, series: usize) -> &'a [CurvePoint] {
        let arm = self.panels.arm(place, series);
        arm.map_or(&[], |arm| &self.curves[arm])
    }

    /// Returns the low, the high and the middle line of a series.
    fn lines(&self, place: usize, series: usize) -> [Vec<(f64, f64)>; 3] {
        let heights: [fn(&CurvePoint) -> f64; 3] =
            [|point| point.low, |point| point.high, |point| point.steps];
        heights.map(|height| {
            let points = self.curve(place, series).iter();
            let at = |point: &CurvePoint| (f64::from(point.episode), height(point));
            points.map(at).collect()
        })
    }
}

impl Plot for Episodes<'_> {
    fn labels(&self) -> [&'static str; 2] {
        ["episode", "steps"]
    }

    fn axes(&self, place: usize) -> [Axis; 2] {
        let series = 0..self.panels.series.len();
        let points = series.flat_map(|series| self.curve(place, series));
        let steps = points.map(|point| point.steps);
        let (low, high) = steps.fold((f64::MAX, 1.0), |(low, high), steps| {
            (f64::min(low, steps), f64::max(high, steps))
        });
        // The first episodes are many times as long as the last ones.
        [
            Axis::linear(0.0, f64::from(self.panels.episodes)),
            Axis::logarithmic(low.min(high), 1.1 * high),
        ]
    }

    fn series(&self, chart: &Chart, place: usize, series: usize, line: Line) -> Vec<Element> {
        banded(chart, &self.lines(place, series), line)
    }

    fn behind(&self, chart: &Chart, place: usize, series: usize, line: Line) -> Vec<Element> {
        let [_, _, curve] = self.lines(place, series);
        vec![chart.curve(&curve, line)]
    }
}
