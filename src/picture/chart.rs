//! Charts: axes, curves, bands and bars in a rectangle of a picture.

use super::colours::css;
use super::drawing::{GRID, INK, block};
use super::svg::{Element, decimals, short};

/// A point of a chart, in the units of its axes.
pub(crate) type Point = (f64, f64);

/// The range of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axis {
    low: f64,
    high: f64,
    is_logarithmic: bool,
}

/// The colour, width and dashes of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    pub colour: u32,
    pub width: f64,
    /// Lengths of dashes and gaps in pixels, as in SVG; empty for a solid line.
    pub dashes: &'static str,
}

/// A rectangle with two axes, in pixels of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Chart {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    pub x: Axis,
    pub y: Axis,
}

/// Where a text begins or ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

impl Axis {
    /// Creates an axis. An empty range becomes one of length 1.
    pub fn linear(low: f64, high: f64) -> Self {
        let high = if high > low { high } else { low + 1.0 };
        Self {
            low,
            high,
            is_logarithmic: false,
        }
    }

    /// Creates a logarithmic axis from the power of ten below `low` to `high`. Both are at least 1.
    pub fn logarithmic(low: f64, high: f64) -> Self {
        let low = 10_f64.powi(low.max(1.0).log10().floor() as i32);
        Self {
            low,
            high: high.max(10.0 * low),
            is_logarithmic: true,
        }
    }

    /// Returns the position of a value, from 0 to 1. Values outside of the range are moved to its ends.
    fn share(&self, value: f64) -> f64 {
        let value = value.clamp(self.low, self.high);
        if self.is_logarithmic {
            (value / self.low).log10() / (self.high / self.low).log10()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// Returns at most `most` round values in the range; on a logarithmic axis, powers of ten.
    fn ticks(&self, most: usize) -> Vec<f64> {
        if self.is_logarithmic {
            let powers = self.low.log10().round() as i32..=self.high.log10().floor() as i32;
            let stride = powers.clone().count().div_ceil(most.max(1));
            let powers = powers.step_by(stride);
            return powers.map(|power| 10_f64.powi(power)).collect();
        }
        let least = (self.high - self.low) / most.saturating_sub(1).max(1) as f64;
        let power = 10_f64.powf(least.log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
        // The tolerance keeps a step that equals the least one but for rounding.
        let fits = |step: &f64| *step > least * (1.0 - 1e-9);
        let step = steps.into_iter().find(fits).unwrap_or(10.0 * power);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        (first..=last).map(|tick| tick as f64 * step).collect()
    }
}

impl Chart {
    /// Returns the position of a point in the picture.
    pub fn at(&self, (x, y): Point) -> (f64, f64) {
        (
            self.left + self.width * self.x.share(x),
            self.top + self.height * (1.0 - self.y.share(y)),
        )
    }

    /// Returns the grid, the axes and the labels of the y axis, and those of the x axis if wanted.
    pub fn frame(&self, size: f64, has_x_labels: bool, y_label: fn(f64) -> String) -> Vec<Element> {
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        let mut shapes = Vec::new();
        // A label takes three times its height, upward, and six times, sideways.
        let most = |length: f64, labels: f64| (length / (labels * size)) as usize + 1;
        for tick in self.y.ticks(most(self.height, 2.4)) {
            let (_, y) = self.at((0.0, tick));
            shapes.push(segment((self.left, y), (right, y), GRID));
            let at = (self.left - 3.0, y + 0.35 * size);
            shapes.push(label(at, size, Anchor::End, y_label(tick)));
        }
        for tick in self.x.ticks(most(self.width, 3.6)) {
            let (x, _) = self.at((tick, 0.0));
            shapes.push(segment((x, bottom), (x, bottom + 3.0), INK));
            if has_x_labels {
                let at = (x, bottom + 4.0 + size);
                shapes.push(label(at, size, Anchor::Middle, thousands(tick)));
            }
        }
        shapes.push(segment((self.left, bottom), (right, bottom), INK));
        shapes.push(segment((self.left, self.top), (self.left, bottom), INK));
        shapes
    }

    /// Returns a line through points.
    pub fn curve(&self, points: &[Point], line: Line) -> Element {
        let attributes = [
            ("points", self.corners(points.iter())),
            ("fill", "none".to_owned()),
            ("stroke", css(line.colour)),
            ("stroke-width", short(line.width)),
            ("stroke-linejoin", "round".to_owned()),
        ];
        let element = Element::new("polyline", attributes);
        if line.dashes.is_empty() {
            element
        } else {
            element.with([("stroke-dasharray", line.dashes.to_owned())])
        }
    }

    /// Returns the pale area between two lines.
    pub fn band(&self, low: &[Point], high: &[Point], colour: u32) -> Element {
        let attributes = [
            ("points", self.corners(low.iter().chain(high.iter().rev()))),
            ("fill", css(colour)),
            ("fill-opacity", "0.16".to_owned()),
        ];
        Element::new("polygon", attributes)
    }

    /// Returns a bar from 0 to a height.
    pub fn bar(&self, from: f64, to: f64, height: f64, colour: u32) -> Element {
        let ((left, top), (right, bottom)) = (self.at((from, height)), self.at((to, 0.0)));
        // A gap, so that neighbours can be told apart.
        block(left + 0.5, top, right - left - 1.0, bottom - top, colour)
    }

    fn corners<'a>(&self, points: impl Iterator<Item = &'a Point>) -> String {
        let points = points.map(|&point| self.at(point));
        let points = points.map(|(x, y)| format!("{},{}", short(x), short(y)));
        points.collect::<Vec<_>>().join(" ")
    }
}

/// Returns a thin line between two points of the picture.
fn segment((x1, y1): (f64, f64), (x2, y2): (f64, f64), colour: u32) -> Element {
    let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(short);
    let stroke = ("stroke", css(colour));
    let width = ("stroke-width", "0.8".to_owned());
    Element::new(
        "line",
        [
            ("x1", x1),
            ("y1", y1),
            ("x2", x2),
            ("y2", y2),
            stroke,
            width,
        ],
    )
}

/// Returns a sample of a line, for a legend.
pub(crate) fn sample(from: (f64, f64), length: f64, line: Line) -> Element {
    let (x, y) = from;
    let unit = Axis::linear(0.0, 1.0);
    let chart = Chart {
        left: x,
        top: y,
        width: length,
        height: 0.0,
        x: unit,
        y: unit,
    };
    chart.curve(&[(0.0, 0.0), (1.0, 0.0)], line)
}

/// Writes text beside, before or around a point.
pub(crate) fn label(at: (f64, f64), size: f64, anchor: Anchor, text: String) -> Element {
    let anchor = match anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    super::drawing::words(at.0, at.1, size, INK, text).with([("text-anchor", anchor.to_owned())])
}

/// Writes text that reads upward, around a point.
pub(crate) fn upright(at: (f64, f64), size: f64, text: String) -> Element {
    let place = format!("translate({} {})rotate(-90)", short(at.0), short(at.1));
    label((0.0, 0.0), size, Anchor::Middle, text).in_group(place)
}

/// Formats a number of an axis, with `k` for thousands.
pub(crate) fn thousands(number: f64) -> String {
    if number.abs() >= 1000.0 {
        decimals(number / 1000.0, 1) + "k"
    } else {
        decimals(number, 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_at_most_as_many_as_asked() {
        assert_eq!(Axis::linear(0.0, 180.0).ticks(5), [0.0, 50.0, 100.0, 150.0]);
        assert_eq!(Axis::linear(0.0, 1.0).ticks(3), [0.0, 0.5, 1.0]);
        assert_eq!(Axis::linear(-60.0, 900.0).ticks(3), [0.0, 500.0]);
        let steps = Axis::logarithmic(30.0, 2e4);
        assert_eq!(steps.ticks(9), [10.0, 100.0, 1e3, 1e4]);
        assert_eq!(steps.ticks(3), [10.0, 1e3]);
        for (low, high) in [(0.0, 7.0), (-3.0, 0.1), (0.0, 1e-3), (5.0, 5.0)] {
            for most in 2..9 {
                let ticks = Axis::linear(low, high).ticks(most);
                assert!((1..=most).contains(&ticks.len()), "{low} {high}: {ticks:?}");
            }
        }
    }

    #[test]
    fn points_outside_of_the_axes_stay_in_the_chart() {
        let chart = Chart {
            left: 10.0,
            top: 20.0,
            width: 100.0,
            height: 50.0,
            x: Axis::logarithmic(1.0, 100.0),
            y: Axis::linear(0.0, 1.0),
        };
        assert_eq!(chart.at((10.0, 0.5)), (60.0, 45.0));
        assert_eq!(chart.at((0.0, 2.0)), (10.0, 20.0));
        assert_eq!(chart.at((1e9, -1.0)), (110.0, 70.0));
    }
}
