//! Environment steps until the policy was globally optimal.

use plotters::prelude::*;

use super::canvas::{Canvas, Drawing, Drawn, Size, draw_line, write, write_title};
use super::panels::Panels;
use super::theme::{BLUE, CENTRED, FAINT, FROM_LEFT, FROM_RIGHT, INK, RED, colour, line, widest};
use crate::agent::power;
use crate::study::analysis::summary::ArmSummary;
use crate::study::statistics::{Interval, Proportion};

const TOP: i32 = 58;
/// Width of a panel's axis, and of its figures.
const AXIS: i32 = 220;
const FIGURES: i32 = 96;
const CAPTION: i32 = 26;
const LABELS: i32 = 46;
/// The width of the note under the title.
const NOTE: i32 = 760;
const ROW: i32 = 18;
/// Maximum number of panels in a row.
const MOST_COLUMNS: usize = 3;
/// Maximum length of a name. Longer names, as in sweeps of many settings, leave no room for the
/// chart.
const LONGEST_NAME: usize = 60;

/// Environment steps and share of optimal trials of one series in one place.
#[derive(Debug, Clone, Copy)]
struct Cost {
    series: usize,
    steps: Interval,
    successes: Proportion,
}

impl Cost {
    fn new(series: usize, arm: &ArmSummary) -> Option<Self> {
        Some(Self {
            series,
            steps: Interval {
                value: arm.iqm_env_steps?,
                low: arm.iqm_env_steps_low?,
                high: arm.iqm_env_steps_high?,
            },
            successes: Proportion::new(arm.successes, arm.trials),
        })
    }

    fn always_optimal(&self) -> bool {
        self.successes.successes == self.successes.trials
    }
}

/// A panel for each place, with a row for each series: steps on a logarithmic axis, and the share
/// of optimal trials. The fewest steps are highlighted.
#[derive(Debug)]
pub struct Steps<'a> {
    panels: &'a Panels<'a>,
    /// The costs in each place.
    costs: Vec<Vec<Cost>>,
    /// The exponents of 10 at which axes begin and end.
    from: u32,
    to: u32,
}

impl<'a> Steps<'a> {
    /// Creates the chart of these panels. `arms` are their summaries. `None` if a name is too long.
    pub fn new(panels: &'a Panels<'a>, arms: &[ArmSummary]) -> Option<Self> {
        if panels.series.iter().any(|name| name.len() > LONGEST_NAME) {
            return None;
        }
        let at = |place| {
            let cost = |series| Cost::new(series, &arms[panels.arm(place, series)?]);
            (0..panels.series.len()).filter_map(cost).collect()
        };
        let costs: Vec<Vec<Cost>> = (0..panels.places.len()).map(at).collect();
        let all = costs.iter().flatten().map(|cost| cost.steps);
        let (low, high) = all.fold((f64::MAX, 1.0_f64), |(low, high), steps| {
            (low.min(steps.low), high.max(steps.high))
        });
        Some(Self {
            panels,
            costs,
            from: exponent(low.min(high)).floor() as u32,
            to: exponent(high * 1.01).ceil() as u32,
        })
    }

    /// Returns the width of the names of the series.
    fn names(&self) -> i32 {
        widest(&self.panels.series) + 24
    }

    fn columns(&self) -> usize {
        self.costs.len().clamp(1, MOST_COLUMNS)
    }

    fn panel_height(&self) -> i32 {
        CAPTION + self.panels.series.len() as i32 * ROW + LABELS
    }

    /// Returns the upper left corner of a panel.
    fn corner(&self, place: usize) -> Size {
        let (row, column) = (place / self.columns(), place % self.columns());
        let left = self.names() + column as i32 * (AXIS + FIGURES);
        (left, TOP + row as i32 * self.panel_height())
    }
}

impl Drawing for Steps<'_> {
    fn size(&self) -> Size {
        let (columns, rows) = (self.columns(), self.costs.len().div_ceil(self.columns()));
        let width = self.names() + columns as i32 * (AXIS + FIGURES);
        (width.max(NOTE), TOP + rows as i32 * self.panel_height())
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let title = "Environment steps until the policy was globally optimal";
        let note = "interquartile mean with 95 % interval, and the share of optimal trials; hollow: not all; red: the fewest steps";
        write_title(canvas, self.size().0 / 2, title, Some((40, note)))?;
        (0..self.costs.len()).try_for_each(|place| self.panel(canvas, place))
    }
}

impl Steps<'_> {
    fn panel(&self, canvas: &Canvas<'_>, place: usize) -> Drawn {
        let (left, top) = self.corner(place);
        let name = &self.panels.places[place];
        write(canvas, 14, FROM_LEFT, (left, top + CAPTION / 2), name)?;
        self.axis(canvas, place)?;
        let fewest = self.costs[place].iter().map(|cost| cost.steps.value);
        let fewest = fewest.fold(f64::INFINITY, f64::min);
        self.costs[place].iter().try_for_each(|cost| {
            let is_best = cost.steps.value == fewest;
            let hue = colour(if is_best { RED } else { BLUE });
            self.dot(canvas, place, cost, hue)?;
            self.words(canvas, place, cost)
        })
    }

    /// Returns the position of a number of steps in the row of a series.
    fn at(&self, place: usize, steps: f64, series: usize) -> (i32, i32) {
        let (left, top) = self.corner(place);
        let length = f64::from((self.to - self.from).max(1));
        let share = (exponent(steps) - f64::from(self.from)) / length;
        let x = f64::from(left) + share * f64::from(AXIS);
        (x as i32, top + CAPTION + series as i32 * ROW + ROW / 2)
    }

    /// Draws a line at each power of ten, with its number below.
    fn axis(&self, canvas: &Canvas<'_>, place: usize) -> Drawn {
        let last = self.panels.series.len();
        for exponent in self.from..=self.to {
            let steps = power(10.0, exponent);
            let (x, top) = self.at(place, steps, 0);
            let (_, bottom) = self.at(place, steps, last);
            draw_line(canvas, [(x, top - ROW / 2), (x, bottom)], line(FAINT, 1))?;
            write(canvas, 11, CENTRED, (x, bottom + 10), &steps.to_string())?;
        }
        let (left, bottom) = self.at(place, power(10.0, self.from), last);
        let (right, _) = self.at(place, power(10.0, self.to), last);
        let middle = (i32::midpoint(left, right), bottom + 26);
        write(
            canvas,
            11,
            CENTRED,
            middle,
            "environment steps (logarithmic)",
        )?;
        draw_line(canvas, [(left, bottom), (right, bottom)], line(INK, 1))
    }

    fn dot(&self, canvas: &Canvas<'_>, place: usize, cost: &Cost, hue: RGBColor) -> Drawn {
        let at = |steps| self.at(place, steps, cost.series);
        let Interval { value, low, high } = cost.steps;
        draw_line(canvas, [at(low), at(high)], line(hue, 2))?;
        canvas.draw(&Circle::new(at(value), 4, WHITE.filled()))?;
        let style = match cost.always_optimal() {
            true => hue.filled(),
            false => line(hue, 2),
        };
        canvas.draw(&Circle::new(at(value), 4, style))
    }

    /// Writes the figures right of the axis, and the name left of the first panel in a row.
    fn words(&self, canvas: &Canvas<'_>, place: usize, cost: &Cost) -> Drawn {
        let (x, y) = self.at(place, power(10.0, self.to), cost.series);
        let steps = format!("{:.0}", cost.steps.value);
        write(canvas, 11, FROM_RIGHT, (x + 46, y), &steps)?;
        let share = format!("{:.0} %", 100.0 * cost.successes.share());
        write(canvas, 11, FROM_RIGHT, (x + 86, y), &share)?;
        let name = &self.panels.series[cost.series];
        match place.is_multiple_of(self.columns()) {
            true => write(canvas, 12, FROM_RIGHT, (self.names() - 10, y), name),
            false => Ok(()),
        }
    }
}

/// Returns the position of a number on an axis of exponents. 0 steps are at 1.
fn exponent(steps: f64) -> f64 {
    steps.max(1.0).log10()
}
