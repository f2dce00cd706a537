//! The paper's Figure 4: when the policy first became globally optimal.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{Drawing, Drawn, Size};
use super::panels::Panels;
use super::theme::{CENTRED, FAINT, INK, Theme, colour, ticks};
use crate::study::analysis::summary::ArmRecords;

/// Approximate number of bars in a panel.
const BARS: u32 = 18;
const PANEL: Size = (330, 140);
const LEFT: u32 = 62;
const TOP: u32 = 58;
const BOTTOM: u32 = 46;

/// A panel for each series (rows) and place (columns), all with the same axes.
#[derive(Debug)]
pub struct Histograms<'a>(pub(super) &'a Panels<'a>);

impl Drawing for Histograms<'_> {
    fn size(&self) -> Size {
        let (columns, rows) = (self.0.places.len() as u32, self.0.series.len() as u32);
        (LEFT + columns * PANEL.0 + 10, TOP + rows * PANEL.1 + BOTTOM)
    }

    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, theme: Theme) -> Drawn<DB> {
        let width = self.0.episodes.div_ceil(BARS).max(1);
        let bars = Bars {
            width,
            highest: highest(self.0, width),
            episodes: self.0.episodes,
        };
        frame(root, theme, width)?;
        for (place, name) in self.0.places.iter().enumerate() {
            let x = theme.ipx((LEFT + place as u32 * PANEL.0 + PANEL.0 / 2) as i32 - 8);
            root.draw_text(name, &theme.text(15).pos(CENTRED), (x, theme.ipx(44)))?;
            for (series, name) in self.0.series.iter().enumerate() {
                let area = panel(root, theme, place as u32, series as u32);
                if let Some(records) = self.0.at(place, series) {
                    bars.draw(&area, theme, records, colour(series))?;
                    label(&area, theme, name, records)?;
                }
            }
        }
        Ok(())
    }
}

/// Draws the titles around the panels.
fn frame<DB: DrawingBackend>(root: &DrawingArea<DB, Shift>, theme: Theme, width: u32) -> Drawn<DB> {
    let (wide, high) = root.dim_in_pixel();
    let (wide, high) = (wide as i32, high as i32);
    let title = "First episode with a globally optimal greedy policy";
    root.draw_text(
        title,
        &theme.text(17).pos(CENTRED),
        (wide / 2, theme.ipx(18)),
    )?;
    let axis = format!("episode (bars of {width})");
    root.draw_text(
        &axis,
        &theme.text(13).pos(CENTRED),
        (wide / 2, high - theme.ipx(14)),
    )?;
    let side = theme
        .text(13)
        .pos(CENTRED)
        .transform(FontTransform::Rotate270);
    root.draw_text("trials", &side, (theme.ipx(14), high / 2))
}

fn panel<DB: DrawingBackend>(
    root: &DrawingArea<DB, Shift>,
    theme: Theme,
    column: u32,
    row: u32,
) -> DrawingArea<DB, Shift> {
    let (left, top) = (LEFT - 34 + column * PANEL.0, TOP + row * PANEL.1);
    let corner = (theme.px(left), theme.px(top));
    root.clone()
        .shrink(corner, (theme.px(PANEL.0), theme.px(PANEL.1)))
}

/// Draws the name of the series, its successes and their interval.
fn label<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    theme: Theme,
    series: &str,
    records: &ArmRecords<'_>,
) -> Drawn<DB> {
    let right = i32::try_from(area.dim_in_pixel().0).unwrap_or(0) - theme.ipx(14);
    let style = theme.text(13).pos(Pos::new(HPos::Right, VPos::Top));
    area.draw_text(series, &style, (right, theme.ipx(8)))?;
    let share = records.successes();
    let wilson = share.wilson();
    let (low, high) = (100.0 * wilson.low, 100.0 * wilson.high);
    let text = format!(
        "{} of {} ({low:.0}–{high:.0} %)",
        share.successes, share.trials
    );
    area.draw_text(&text, &style, (right, theme.ipx(25)))?;
    let held = records.mean_share_after_first();
    let held = held.map_or(String::new(), |held| {
        format!(", optimal in {:.0} % after", 100.0 * held)
    });
    let text = format!("retained {}{held}", records.retained());
    area.draw_text(&text, &style, (right, theme.ipx(42)))
}

/// The properties that all panels share.
struct Bars {
    width: u32,
    highest: u32,
    episodes: u32,
}

impl Bars {
    fn draw<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        theme: Theme,
        records: &ArmRecords<'_>,
        fill: RGBColor,
    ) -> Drawn<DB> {
        let mut chart = ChartBuilder::on(area)
            .set_label_area_size(LabelAreaPosition::Left, theme.px(34))
            .set_label_area_size(LabelAreaPosition::Bottom, theme.px(20))
            .margin_right(theme.px(10))
            .margin_top(theme.px(4))
            .build_cartesian_2d(
                (0..self.episodes).with_key_points(ticks(self.episodes)),
                0..self.highest,
            )?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(theme.line(FAINT, 1))
            .axis_style(theme.line(INK, 1))
            .x_labels(20)
            .y_labels(4)
            .label_style(theme.text(11))
            .draw()?;
        let counts = counts(records, self.width, self.episodes);
        chart.draw_series(counts.iter().zip(0..).map(|(&count, bin)| {
            let (left, right) = (bin * self.width, (bin + 1) * self.width);
            let mut bar = Rectangle::new(
                [(left, 0), (right.min(self.episodes), count)],
                fill.filled(),
            );
            bar.set_margin(0, 0, theme.px(1), theme.px(1));
            bar
        }))?;
        Ok(())
    }
}

/// Counts the first optimal episodes in each bin. Episode 1 is in the first bin.
fn counts(records: &ArmRecords<'_>, width: u32, episodes: u32) -> Vec<u32> {
    let mut counts = vec![0; episodes.div_ceil(width) as usize];
    for lifetime in records.lifetimes() {
        if lifetime.happened {
            counts[((lifetime.time - 1) / width) as usize] += 1;
        }
    }
    counts
}

fn highest(panels: &Panels<'_>, width: u32) -> u32 {
    let mut highest = 1;
    for place in 0..panels.places.len() {
        for series in 0..panels.series.len() {
            let records = panels.at(place, series);
            let counts = records.map(|one| counts(one, width, panels.episodes));
            highest = highest.max(counts.into_iter().flatten().max().unwrap_or(0));
        }
    }
    // Leave room for the label above the bars.
    highest + highest.div_ceil(4)
}
