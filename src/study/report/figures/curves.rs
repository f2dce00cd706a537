//! Success curves: the share of trials that have found an optimal policy, by episode.

use plotters::coord::Shift;
use plotters::coord::combinators::WithKeyPoints;
use plotters::coord::types::{RangedCoordf64, RangedCoordu32};
use plotters::prelude::*;

use super::canvas::{Drawing, Drawn, Size};
use super::panels::Panels;
use super::theme::{CENTRED, FAINT, FROM_LEFT, INK, Theme, colour, ticks, widest};
use crate::study::statistics::{Lifetime, Point, Survival};

const PANEL: Size = (340, 300);
const TOP: u32 = 36;
/// Minimum width of the names next to the table of unsolved trials, and the margin of longer names.
const NAMES: u32 = 176;
const BESIDE_NAMES: u32 = 50;
const ROW: u32 = 17;

type Chart<'a, DB> =
    ChartContext<'a, DB, Cartesian2d<WithKeyPoints<RangedCoordu32>, RangedCoordf64>>;

/// A panel for each place, with 1 - Kaplan-Meier and its 95 % band for each series. A table below
/// shows how many trials are still searching.
#[derive(Debug)]
pub struct Curves<'a>(pub(super) &'a Panels<'a>);

impl Drawing for Curves<'_> {
    fn size(&self) -> Size {
        let (columns, rows) = (self.0.places.len() as u32, self.0.series.len() as u32);
        (
            self.names_width() + columns * PANEL.0 + 10,
            TOP + PANEL.1 + (rows + 2) * ROW + 12,
        )
    }

    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, theme: Theme) -> Drawn<DB> {
        let middle = i32::try_from(root.dim_in_pixel().0 / 2).unwrap_or(0);
        let style = theme.text(17).pos(CENTRED);
        let title = "Trials that had found a globally optimal policy (95 % bands)";
        root.draw_text(title, &style, (middle, theme.ipx(18)))?;
        self.names(root, theme)?;
        (0..self.0.places.len()).try_for_each(|place| self.panel(root, theme, place))
    }
}

impl Curves<'_> {
    fn names_width(&self) -> u32 {
        NAMES.max(BESIDE_NAMES + widest(&self.0.series))
    }

    /// Draws the names of the series, which label the rows of the table and explain the colours.
    fn names<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, theme: Theme) -> Drawn<DB> {
        let style = theme.text(12).pos(FROM_LEFT);
        root.draw_text("still searching", &style, (theme.ipx(8), row(theme, 0)))?;
        for (series, name) in self.0.series.iter().enumerate() {
            let y = row(theme, series + 1);
            let line = vec![(theme.ipx(8), y), (theme.ipx(28), y)];
            root.draw(&PathElement::new(line, theme.line(colour(series), 3)))?;
            root.draw_text(name, &style, (theme.ipx(34), y))?;
        }
        Ok(())
    }

    fn panel<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        theme: Theme,
        place: usize,
    ) -> Drawn<DB> {
        let left = self.names_width() - 46 + place as u32 * PANEL.0;
        let corner = (theme.px(left), theme.px(TOP));
        let area = root
            .clone()
            .shrink(corner, (theme.px(PANEL.0), theme.px(PANEL.1)));
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.0.places[place], theme.text(15))
            .set_label_area_size(LabelAreaPosition::Left, theme.px(46))
            .set_label_area_size(LabelAreaPosition::Bottom, theme.px(34))
            .margin_right(theme.px(16))
            .build_cartesian_2d(
                (0..self.0.episodes).with_key_points(ticks(self.0.episodes)),
                0.0..1.0,
            )?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(theme.line(FAINT, 1))
            .axis_style(theme.line(INK, 1))
            .x_labels(20)
            .y_labels(6)
            .y_label_formatter(&|share| format!("{:.0} %", 100.0 * share))
            .x_desc("episode")
            .axis_desc_style(theme.text(12))
            .label_style(theme.text(11))
            .draw()?;
        for series in 0..self.0.series.len() {
            if let Some(records) = self.0.at(place, series) {
                let lifetimes = records.lifetimes();
                self.curve(&mut chart, theme, series, &lifetimes)?;
                self.still_searching(root, &chart, theme, series, &lifetimes)?;
            }
        }
        Ok(())
    }

    fn curve<DB: DrawingBackend>(
        &self,
        chart: &mut Chart<'_, DB>,
        theme: Theme,
        series: usize,
        lifetimes: &[Lifetime],
    ) -> Drawn<DB> {
        let survival = Survival::new(lifetimes);
        let steps = |share: fn(&Point) -> f64| staircase(survival.points(), self.0.episodes, share);
        let mut band = steps(|point| 1.0 - point.low);
        band.extend(steps(|point| 1.0 - point.high).into_iter().rev());
        let hue = colour(series);
        chart.draw_series([Polygon::new(band, hue.mix(0.18).filled())])?;
        let line = steps(|point| 1.0 - point.value);
        chart.draw_series([PathElement::new(line, theme.line(hue, 2))])?;
        Ok(())
    }

    /// Draws the number of trials that are still searching at some episodes, under the chart.
    fn still_searching<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        chart: &Chart<'_, DB>,
        theme: Theme,
        series: usize,
        lifetimes: &[Lifetime],
    ) -> Drawn<DB> {
        let style = theme.text(11).pos(CENTRED);
        for episode in ticks(self.0.episodes) {
            let (x, _) = chart.backend_coord(&(episode, 0.0));
            let found = |one: &&Lifetime| one.happened && one.time <= episode;
            let searching = lifetimes.len() - lifetimes.iter().filter(found).count();
            root.draw_text(&searching.to_string(), &style, (x, row(theme, series + 1)))?;
        }
        Ok(())
    }
}

/// Returns the vertical middle of a row of the table. Row 0 is its heading.
fn row(theme: Theme, row: usize) -> i32 {
    theme.ipx((TOP + PANEL.1 + row as u32 * ROW + ROW / 2 + 4) as i32)
}

/// Returns the corners of a staircase through the points, up to the last episode.
fn staircase(points: &[Point], episodes: u32, share: impl Fn(&Point) -> f64) -> Vec<(u32, f64)> {
    let mut corners = Vec::new();
    let mut before = 0.0;
    for point in points {
        corners.push((point.time, before));
        before = share(point);
        corners.push((point.time, before));
    }
    corners.push((episodes, before));
    corners
}
