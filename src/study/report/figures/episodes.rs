//! Learning curves: the steps of each episode.

use plotters::prelude::*;

use super::canvas::{Canvas, Drawing, Drawn, Size, draw_curve, draw_key, write_title};
use super::panels::Panels;
use super::theme::{FAINT, INK, line, text, widest};
use crate::study::analysis::learning::CurvePoint;

const PANEL: Size = (360, 300);
const TOP: i32 = 36;
const ROW: i32 = 17;
/// The maximum number of panels side by side.
const COLUMNS: i32 = 3;

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

    fn names_width(&self) -> i32 {
        50 + widest(&self.panels.series)
    }
}

impl Drawing for Episodes<'_> {
    fn size(&self) -> Size {
        let (panels, names) = self.panels.size();
        let columns = panels.min(COLUMNS);
        let rows = (panels + COLUMNS - 1) / COLUMNS;
        let high = (rows * PANEL.1).max(names * ROW + 40);
        (self.names_width() + columns * PANEL.0 + 10, TOP + high + 10)
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let title = "Steps per episode (mean and its 95 % interval)";
        write_title(canvas, self.size().0 / 2, title, None)?;
        for (series, name) in self.panels.series.iter().enumerate() {
            draw_key(canvas, series, TOP + 40 + series as i32 * ROW, name)?;
        }
        (0..self.panels.places.len()).try_for_each(|place| self.panel(canvas, place))
    }
}

impl Episodes<'_> {
    fn panel(&self, canvas: &Canvas<'_>, place: usize) -> Drawn {
        let (column, row) = (place as i32 % COLUMNS, place as i32 / COLUMNS);
        let corner = (self.names_width() + column * PANEL.0, TOP + row * PANEL.1);
        let curves = 0..self.panels.series.len();
        let highest = curves.clone().flat_map(|series| self.curve(place, series));
        let highest = highest.map(|point| point.high).fold(1.0, f64::max);
        let mut chart = ChartBuilder::on(&canvas.clone().shrink(corner, PANEL))
            .caption(&self.panels.places[place], text(15))
            .set_label_area_size(LabelAreaPosition::Left, 46)
            .set_label_area_size(LabelAreaPosition::Bottom, 34)
            .margin_right(16)
            .build_cartesian_2d(1.0..f64::from(self.panels.episodes.max(2)), 0.0..highest)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(line(FAINT, 1))
            .axis_style(line(INK, 1))
            .x_labels(6)
            .y_labels(6)
            .x_label_formatter(&|episode| format!("{episode:.0}"))
            .y_label_formatter(&|steps| format!("{steps:.0}"))
            .x_desc("episode")
            .y_desc("steps")
            .axis_desc_style(text(12))
            .label_style(text(11))
            .draw()?;
        let heights: [fn(&CurvePoint) -> f64; 3] =
            [|point| point.low, |point| point.high, |point| point.steps];
        for series in curves {
            let along = |height: fn(&CurvePoint) -> f64| {
                let points = self.curve(place, series).iter();
                let at = |point: &CurvePoint| (f64::from(point.episode), height(point).max(0.0));
                points.map(at).collect()
            };
            draw_curve(&mut chart, series, heights.map(along))?;
        }
        Ok(())
    }
}
