//! Success curves: the share of trials that have found an optimal policy, by episode.

use plotters::coord::combinators::WithKeyPoints;
use plotters::coord::types::{RangedCoordf64, RangedCoordu32};
use plotters::prelude::*;

use super::canvas::{
    Canvas, Chart, Drawing, Drawn, Size, draw_curve, draw_key, write, write_title,
};
use super::panels::Panels;
use super::theme::{CENTRED, FAINT, FROM_LEFT, INK, line, text, ticks, widest};
use crate::study::analysis::summary::ArmRecords;
use crate::study::statistics::Interval;

const PANEL: Size = (340, 300);
const TOP: i32 = 36;
/// Minimum width of the names next to the table of unsolved trials, and the margin of longer names.
const NAMES: i32 = 176;
const BESIDE_NAMES: i32 = 50;
const ROW: i32 = 17;

type ByEpisode<'a, 'b> = Chart<'a, 'b, WithKeyPoints<RangedCoordu32>, RangedCoordf64>;

/// A panel for each place, with the share of solved trials and Wilson's 95 % band for each series. A
/// table below shows how many trials are still searching.
#[derive(Debug)]
pub struct Curves<'a>(pub(super) &'a Panels<'a>);

impl Drawing for Curves<'_> {
    fn size(&self) -> Size {
        let (columns, rows) = self.0.size();
        let width = self.names_width() + columns * PANEL.0 + 10;
        (width, TOP + PANEL.1 + (rows + 2) * ROW + 12)
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let title = "Trials that had found a globally optimal policy (95 % bands)";
        write_title(canvas, self.size().0 / 2, title, None)?;
        // The names label the rows of the table, and explain the colours.
        write(canvas, 12, FROM_LEFT, (8, row(0)), "still searching")?;
        for (series, name) in self.0.series.iter().enumerate() {
            draw_key(canvas, series, row(series + 1), name)?;
        }
        (0..self.0.places.len()).try_for_each(|place| self.panel(canvas, place))
    }
}

impl Curves<'_> {
    fn names_width(&self) -> i32 {
        NAMES.max(BESIDE_NAMES + widest(&self.0.series))
    }

    fn panel(&self, canvas: &Canvas<'_>, place: usize) -> Drawn {
        let left = self.names_width() - 46 + place as i32 * PANEL.0;
        let episodes = self.0.episodes;
        let mut chart = ChartBuilder::on(&canvas.clone().shrink((left, TOP), PANEL))
            .caption(&self.0.places[place], text(15))
            .set_label_area_size(LabelAreaPosition::Left, 46)
            .set_label_area_size(LabelAreaPosition::Bottom, 34)
            .margin_right(16)
            .build_cartesian_2d((0..episodes).with_key_points(ticks(episodes)), 0.0..1.0)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(line(FAINT, 1))
            .axis_style(line(INK, 1))
            .x_labels(20)
            .y_labels(6)
            .y_label_formatter(&|share| format!("{:.0} %", 100.0 * share))
            .x_desc("episode")
            .axis_desc_style(text(12))
            .label_style(text(11))
            .draw()?;
        for series in 0..self.0.series.len() {
            if let Some(records) = self.0.at(place, series) {
                let steps = records.solved_by_episode();
                let shares: [fn(&Interval) -> f64; 3] =
                    [|share| share.low, |share| share.high, |share| share.value];
                let stairs = shares.map(|share| staircase(&steps, episodes, share));
                draw_curve(&mut chart, series, stairs)?;
                self.still_searching(canvas, &chart, series, records)?;
            }
        }
        Ok(())
    }

    /// Writes the number of trials that are still searching at some episodes, under the chart.
    fn still_searching(
        &self,
        canvas: &Canvas<'_>,
        chart: &ByEpisode<'_, '_>,
        series: usize,
        records: &ArmRecords<'_>,
    ) -> Drawn {
        let (trials, firsts) = (records.successes().trials, records.first_episodes());
        ticks(self.0.episodes).into_iter().try_for_each(|episode| {
            let (x, _) = chart.backend_coord(&(episode, 0.0));
            let found = firsts.partition_point(|first| *first <= episode);
            let searching = trials - found as u64;
            let at = (x, row(series + 1));
            write(canvas, 11, CENTRED, at, &searching.to_string())
        })
    }
}

/// Returns the vertical middle of a row of the table. Row 0 is its heading.
fn row(row: usize) -> i32 {
    TOP + PANEL.1 + row as i32 * ROW + ROW / 2 + 4
}

/// Returns the corners of a staircase through the steps, up to the last episode.
fn staircase(
    steps: &[(u32, Interval)],
    episodes: u32,
    share: impl Fn(&Interval) -> f64,
) -> Vec<(u32, f64)> {
    let mut corners: Vec<(u32, f64)> = Vec::new();
    for (episode, interval) in steps {
        let episode = episodes.min(*episode);
        corners.extend(corners.last().map(|(_, before)| (episode, *before)));
        corners.push((episode, share(interval)));
    }
    corners.extend(corners.last().map(|(_, last)| (episodes, *last)));
    corners
}
