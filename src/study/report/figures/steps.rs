//! Environment steps until the policy was globally optimal.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::canvas::{Drawing, Drawn, Size};
use super::panels::Panels;
use super::theme::{BLUE, CENTRED, FAINT, FROM_LEFT, FROM_RIGHT, INK, RED, Theme, colour, widest};
use crate::agent::power;
use crate::study::analysis::summary::ArmSummary;
use crate::study::statistics::{Interval, Proportion};

const TOP: u32 = 58;
/// Width of a panel's axis, and of its figures.
const AXIS: u32 = 220;
const FIGURES: u32 = 96;
const CAPTION: u32 = 26;
const LABELS: u32 = 46;
/// The width of the note under the title.
const NOTE: u32 = 760;
const ROW: u32 = 18;
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
            successes: Proportion {
                successes: arm.successes,
                trials: arm.trials,
            },
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
    fn names(&self) -> u32 {
        widest(&self.panels.series) + 24
    }

    fn columns(&self) -> usize {
        self.costs.len().clamp(1, MOST_COLUMNS)
    }

    fn panel_height(&self) -> u32 {
        CAPTION + self.panels.series.len() as u32 * ROW + LABELS
    }

    /// Returns the upper left corner of a panel.
    fn corner(&self, place: usize) -> (u32, u32) {
        let (row, column) = (place / self.columns(), place % self.columns());
        let left = self.names() + column as u32 * (AXIS + FIGURES);
        (left, TOP + row as u32 * self.panel_height())
    }
}

impl Drawing for Steps<'_> {
    fn size(&self) -> Size {
        let (columns, rows) = (self.columns(), self.costs.len().div_ceil(self.columns()));
        let width = self.names() + columns as u32 * (AXIS + FIGURES);
        (width.max(NOTE), TOP + rows as u32 * self.panel_height())
    }

    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, theme: Theme) -> Drawn<DB> {
        let middle = theme.px(self.size().0 / 2) as i32;
        let title = "Environment steps until the policy was globally optimal";
        let at = (middle, theme.ipx(18));
        root.draw_text(title, &theme.text(17).pos(CENTRED), at)?;
        let note = "interquartile mean with 95 % interval, and the share of optimal trials; hollow: not all; red: the fewest steps";
        let at = (middle, theme.ipx(40));
        root.draw_text(note, &theme.text(12).pos(CENTRED), at)?;
        (0..self.costs.len()).try_for_each(|place| self.panel(root, theme, place))
    }
}

impl Steps<'_> {
    fn panel<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        theme: Theme,
        place: usize,
    ) -> Drawn<DB> {
        let (left, top) = self.corner(place);
        let name = theme.text(14).pos(FROM_LEFT);
        let at = (theme.px(left) as i32, theme.px(top + CAPTION / 2) as i32);
        root.draw_text(&self.panels.places[place], &name, at)?;
        self.axis(root, theme, place)?;
        let fewest = self.costs[place].iter().map(|cost| cost.steps.value);
        let fewest = fewest.fold(f64::INFINITY, f64::min);
        self.costs[place].iter().try_for_each(|cost| {
            let hue = if cost.steps.value == fewest {
                RED
            } else {
                BLUE
            };
            self.dot(root, theme, place, cost, colour(hue))?;
            self.words(root, theme, place, cost)
        })
    }

    /// Returns the position of a number of steps in the row of a series, in pixels.
    fn at(&self, theme: Theme, place: usize, steps: f64, series: usize) -> (i32, i32) {
        let (left, top) = self.corner(place);
        let share =
            (exponent(steps) - f64::from(self.from)) / f64::from((self.to - self.from).max(1));
        let x = f64::from(theme.px(left)) + share * f64::from(theme.px(AXIS));
        let y = theme.px(top + CAPTION + series as u32 * ROW + ROW / 2);
        (x as i32, y as i32)
    }

    /// Draws a line at each power of ten, with its number below.
    fn axis<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        theme: Theme,
        place: usize,
    ) -> Drawn<DB> {
        let last = self.panels.series.len();
        for exponent in self.from..=self.to {
            let steps = power(10.0, exponent);
            let (x, top) = self.at(theme, place, steps, 0);
            let (_, bottom) = self.at(theme, place, steps, last);
            let line = [(x, top - theme.ipx(ROW as i32 / 2)), (x, bottom)];
            root.draw(&PathElement::new(line, theme.line(FAINT, 1)))?;
            let below = (x, bottom + theme.ipx(10));
            root.draw_text(&steps.to_string(), &theme.text(11).pos(CENTRED), below)?;
        }
        let (left, bottom) = self.at(theme, place, power(10.0, self.from), last);
        let (right, _) = self.at(theme, place, power(10.0, self.to), last);
        let middle = (i32::midpoint(left, right), bottom + theme.ipx(26));
        let unit = "environment steps (logarithmic)";
        root.draw_text(unit, &theme.text(11).pos(CENTRED), middle)?;
        let ends = [(left, bottom), (right, bottom)];
        root.draw(&PathElement::new(ends, theme.line(INK, 1)))
    }

    fn dot<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        theme: Theme,
        place: usize,
        cost: &Cost,
        hue: RGBColor,
    ) -> Drawn<DB> {
        let at = |steps| self.at(theme, place, steps, cost.series);
        let Interval { value, low, high } = cost.steps;
        root.draw(&PathElement::new([at(low), at(high)], theme.line(hue, 2)))?;
        root.draw(&Circle::new(at(value), theme.ipx(4), WHITE.filled()))?;
        let style = match cost.always_optimal() {
            true => hue.filled(),
            false => theme.line(hue, 2),
        };
        root.draw(&Circle::new(at(value), theme.ipx(4), style))
    }

    /// Draws the figures right of the axis, and the name left of the first panel in a row.
    fn words<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        theme: Theme,
        place: usize,
        cost: &Cost,
    ) -> Drawn<DB> {
        let (x, y) = self.at(theme, place, power(10.0, self.to), cost.series);
        let figure = theme.text(11).pos(FROM_RIGHT);
        let steps = format!("{:.0}", cost.steps.value);
        root.draw_text(&steps, &figure, (x + theme.ipx(46), y))?;
        let share = format!("{:.0} %", 100.0 * cost.successes.share());
        root.draw_text(&share, &figure, (x + theme.ipx(86), y))?;
        if !place.is_multiple_of(self.columns()) {
            return Ok(());
        }
        let at = (theme.px(self.names()) as i32 - theme.ipx(10), y);
        let name = &self.panels.series[cost.series];
        root.draw_text(name, &theme.text(12).pos(FROM_RIGHT), at)
    }
}

/// Returns the position of a number on an axis of exponents. 0 steps are at 1.
fn exponent(steps: f64) -> f64 {
    steps.max(1.0).log10()
}
