//! The paper's Figure 4: when the policy first became globally optimal.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{Canvas, Drawing, Drawn, Size, write, write_title};
use super::panels::Panels;
use super::theme::{CENTRED, FAINT, INK, colour, line, text, ticks};
use crate::study::analysis::summary::ArmRecords;

/// Approximate number of bars in a panel.
const BARS: u32 = 18;
const PANEL: Size = (330, 140);
const LEFT: i32 = 62;
const TOP: i32 = 58;
const BOTTOM: i32 = 46;

/// A panel for each series (rows) and place (columns), all with the same axes.
#[derive(Debug)]
pub struct Histograms<'a>(pub(super) &'a Panels<'a>);

impl Drawing for Histograms<'_> {
    fn size(&self) -> Size {
        let (columns, rows) = self.0.size();
        (LEFT + columns * PANEL.0 + 10, TOP + rows * PANEL.1 + BOTTOM)
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let bars = Bars::new(self.0);
        self.frame(canvas, bars.width)?;
        for (place, name) in self.0.places.iter().enumerate() {
            let left = LEFT + place as i32 * PANEL.0;
            write(canvas, 15, CENTRED, (left + PANEL.0 / 2 - 8, 44), name)?;
            for (series, name) in self.0.series.iter().enumerate() {
                let corner = (left - 34, TOP + series as i32 * PANEL.1);
                let area = canvas.clone().shrink(corner, PANEL);
                if let Some(records) = self.0.at(place, series) {
                    bars.draw(&area, records, colour(series))?;
                    label(&area, name, records)?;
                }
            }
        }
        Ok(())
    }
}

impl Histograms<'_> {
    /// Writes the titles around the panels.
    fn frame(&self, canvas: &Canvas<'_>, width: u32) -> Drawn {
        let (wide, high) = self.size();
        let title = "First episode with a globally optimal greedy policy";
        write_title(canvas, wide / 2, title, None)?;
        let axis = format!("episode (bars of {width})");
        write(canvas, 13, CENTRED, (wide / 2, high - 14), &axis)?;
        let side = text(13).pos(CENTRED).transform(FontTransform::Rotate270);
        canvas.draw_text("trials", &side, (14, high / 2))
    }
}

/// Writes the name of the series, its successes and their interval.
fn label(area: &Canvas<'_>, series: &str, records: &ArmRecords<'_>) -> Drawn {
    let (share, wilson) = (records.successes(), records.successes().wilson());
    let (low, high) = (100.0 * wilson.low, 100.0 * wilson.high);
    let (successes, trials) = (share.successes, share.trials);
    let solved = format!("{successes} of {trials} ({low:.0}–{high:.0} %)");
    let held = records.mean_share_after_first();
    let held = held.map_or(String::new(), |held| {
        format!(", optimal in {:.0} % after", 100.0 * held)
    });
    let retained = format!("retained {}{held}", records.retained());
    let corner = Pos::new(HPos::Right, VPos::Top);
    for (y, words) in [(8, series), (25, &solved), (42, &retained)] {
        write(area, 13, corner, (PANEL.0 - 14, y), words)?;
    }
    Ok(())
}

/// The properties that all panels share.
struct Bars {
    width: u32,
    highest: u32,
    episodes: u32,
}

impl Bars {
    fn new(panels: &Panels<'_>) -> Self {
        let mut bars = Self {
            width: panels.episodes.div_ceil(BARS).max(1),
            highest: 1,
            episodes: panels.episodes,
        };
        let counts = panels.records().iter().flat_map(|one| bars.counts(one));
        let highest = counts.max().unwrap_or(0).max(1);
        // Leave room for the label above the bars.
        bars.highest = highest + highest.div_ceil(4);
        bars
    }

    /// Counts the first optimal episodes in each bin. Episode 1 is in the first bin.
    fn counts(&self, records: &ArmRecords<'_>) -> Vec<u32> {
        let mut counts = vec![0; self.episodes.div_ceil(self.width) as usize];
        for lifetime in records.lifetimes().iter().filter(|one| one.happened) {
            counts[((lifetime.time - 1) / self.width) as usize] += 1;
        }
        counts
    }

    fn draw(&self, area: &Canvas<'_>, records: &ArmRecords<'_>, fill: RGBColor) -> Drawn {
        let episodes = (0..self.episodes).with_key_points(ticks(self.episodes));
        let mut chart = ChartBuilder::on(area)
            .set_label_area_size(LabelAreaPosition::Left, 34)
            .set_label_area_size(LabelAreaPosition::Bottom, 20)
            .margin_right(10)
            .margin_top(4)
            .build_cartesian_2d(episodes, 0..self.highest)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(line(FAINT, 1))
            .axis_style(line(INK, 1))
            .x_labels(20)
            .y_labels(4)
            .label_style(text(11))
            .draw()?;
        let bar = |(bin, count): (u32, u32)| {
            let right = ((bin + 1) * self.width).min(self.episodes);
            let corners = [(bin * self.width, 0), (right, count)];
            let mut bar = Rectangle::new(corners, fill.filled());
            bar.set_margin(0, 0, 1, 1);
            bar
        };
        chart.draw_series((0..).zip(self.counts(records)).map(bar))?;
        Ok(())
    }
}
