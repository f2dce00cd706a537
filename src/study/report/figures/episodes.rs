//! Learning curves: the steps of each episode.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::canvas::{Drawing, Drawn, Size};
use super::panels::Panels;
use super::theme::{CENTRED, FAINT, FROM_LEFT, INK, Theme, colour, widest};
use crate::study::analysis::learning::CurvePoint;

const PANEL: Size = (360, 300);
const TOP: u32 = 36;
const ROW: u32 = 17;

/// A panel for each place, with the mean steps of each episode and their interval for each series.
#[derive(Debug)]
pub struct Episodes<'a> {
    panels: &'a Panels<'a>,
    /// By arm.
    curves: &'a [Vec<CurvePoint>],
}

impl<'a> Episodes<'a> {
    /// Creates the chart of these panels from the curve of each arm.
    pub fn new(panels: &'a Panels<'a>, curves: &'a [Vec<CurvePoint>]) -> Self {
        Self { panels, curves }
    }

    fn curve(&self, place: usize, series: usize) -> &'a [CurvePoint] {
        let arm = self.panels.arm(place, series);
        arm.map_or(&[], |arm| &self.curves[arm])
    }

    fn names_width(&self) -> u32 {
        50 + widest(&self.panels.series)
    }
}

impl Drawing for Episodes<'_> {
    fn size(&self) -> Size {
        let (columns, rows) = (
            self.panels.places.len() as u32,
            self.panels.series.len() as u32,
        );
        let high = PANEL.1.max(rows * ROW + 40);
        (self.names_width() + columns * PANEL.0 + 10, TOP + high + 10)
    }

    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, theme: Theme) -> Drawn<DB> {
        let middle = i32::try_from(root.dim_in_pixel().0 / 2).unwrap_or(0);
        let style = theme.text(17).pos(CENTRED);
        let title = "Steps per episode (mean and its 95 % interval)";
        root.draw_text(title, &style, (middle, theme.ipx(18)))?;
        let style = theme.text(12).pos(FROM_LEFT);
        for (series, name) in self.panels.series.iter().enumerate() {
            let y = theme.ipx((TOP + 40 + series as u32 * ROW) as i32);
            let line = vec![(theme.ipx(8), y), (theme.ipx(28), y)];
            root.draw(&PathElement::new(line, theme.line(colour(series), 3)))?;
            root.draw_text(name, &style, (theme.ipx(34), y))?;
        }
        (0..self.panels.places.len()).try_for_each(|place| self.panel(root, theme, place))
    }
}

impl Episodes<'_> {
    fn panel<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        theme: Theme,
        place: usize,
    ) -> Drawn<DB> {
        let corner = (
            theme.px(self.names_width() + place as u32 * PANEL.0),
            theme.px(TOP),
        );
        let size = (theme.px(PANEL.0), theme.px(PANEL.1));
        let area = root.clone().shrink(corner, size);
        let curves = 0..self.panels.series.len();
        let highest = curves.clone().flat_map(|series| self.curve(place, series));
        let highest = highest.map(|point| point.high).fold(1.0, f64::max);
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.panels.places[place], theme.text(15))
            .set_label_area_size(LabelAreaPosition::Left, theme.px(46))
            .set_label_area_size(LabelAreaPosition::Bottom, theme.px(34))
            .margin_right(theme.px(16))
            .build_cartesian_2d(1.0..f64::from(self.panels.episodes.max(2)), 0.0..highest)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(theme.line(FAINT, 1))
            .axis_style(theme.line(INK, 1))
            .x_labels(6)
            .y_labels(6)
            .x_label_formatter(&|episode| format!("{episode:.0}"))
            .y_label_formatter(&|steps| format!("{steps:.0}"))
            .x_desc("episode")
            .y_desc("steps")
            .axis_desc_style(theme.text(12))
            .label_style(theme.text(11))
            .draw()?;
        for series in curves {
            let (points, hue) = (self.curve(place, series), colour(series));
            let along = |height: fn(&CurvePoint) -> f64| {
                let points = points.iter();
                points.map(move |point| (f64::from(point.episode), height(point).max(0.0)))
            };
            let mut band: Vec<(f64, f64)> = along(|point| point.high).collect();
            band.extend(
                along(|point| point.low)
                    .collect::<Vec<_>>()
                    .into_iter()
                    .rev(),
            );
            chart.draw_series([Polygon::new(band, hue.mix(0.18).filled())])?;
            let line: Vec<(f64, f64)> = along(|point| point.steps).collect();
            chart.draw_series([PathElement::new(line, theme.line(hue, 2))])?;
        }
        Ok(())
    }
}
