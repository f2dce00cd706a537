//! The layout that all figures share: small multiples in the width of a column.

use super::panels::Panels;
use crate::picture::chart::{Anchor, Axis, Chart, Line, label, sample, thousands, upright};
use crate::picture::svg::{Drawing, Element};
use crate::picture::{PAPER, block};

/// Width of a column of print: 88 mm at 96 dots per inch.
const WIDTH: f64 = 333.0;
/// Text sizes: 6.8 and 7.5 points.
const SMALL: f64 = 9.0;
const TEXT: f64 = 10.0;
/// Space for the label of the y axis of the figure, and for the numbers of each panel.
const Y_LABEL: f64 = 13.0;
const Y_NUMBERS: f64 = 23.0;
/// Space for the numbers of the x axis.
const X_NUMBERS: f64 = 18.0;
/// Height of a line of text with its distance to the next.
const ROW: f64 = 14.0;
const MARGIN: f64 = 6.0;
/// The maximum number of panels side by side.
const MOST_COLUMNS: usize = 3;

/// Colours that colour-blind people can distinguish (Okabe and Ito 2008), each with dashes that tell the lines apart
/// without colour.
const LINES: [(u32, &str); 4] = [
    (0x0072b2, ""),
    (0xd55e00, "6 2.5"),
    (0x009e73, "1.5 2"),
    (0x5a5a5a, "8 2.5 1.5 2.5"),
];
/// The colour of the other series behind the one of a panel.
const FAINT: u32 = 0xc3c9d2;

/// What a figure shows in each panel.
pub(super) trait Plot {
    /// The labels of the x and the y axis.
    fn labels(&self) -> [&'static str; 2];

    /// The axes of all panels of a place.
    fn axes(&self, place: usize) -> [Axis; 2];

    /// Formats a number of the y axis.
    fn y_number(&self) -> fn(f64) -> String {
        thousands
    }

    /// Returns true if each series needs a panel of its own.
    fn is_apart(&self) -> bool {
        false
    }

    /// Draws a series in a panel.
    fn series(&self, chart: &Chart, place: usize, series: usize, line: Line) -> Vec<Element>;

    /// Draws a series faintly behind another one.
    fn behind(&self, chart: &Chart, place: usize, series: usize, line: Line) -> Vec<Element>;
}

/// Draws a figure of these panels. A few series share the panel of a place and differ by line. More series get a
/// panel each, with the others faintly behind.
pub(super) fn figure(name: &str, panels: &Panels<'_>, plot: &dyn Plot) -> Drawing {
    let mut sheet = Sheet {
        panels,
        plot,
        bottom: MARGIN,
        elements: Vec::new(),
    };
    if plot.is_apart() || panels.series.len() > LINES.len() {
        sheet.draw_apart();
    } else {
        sheet.draw_together();
    }
    sheet.finish(name)
}

/// A figure that is drawn from the top to the bottom.
struct Sheet<'a> {
    panels: &'a Panels<'a>,
    plot: &'a dyn Plot,
    /// The lower end of what is drawn.
    bottom: f64,
    elements: Vec<Element>,
}

impl Sheet<'_> {
    /// Draws a legend, and below it a panel for each place with all series.
    fn draw_together(&mut self) {
        self.draw_legend();
        let places: Vec<usize> = (0..self.panels.places.len()).collect();
        let columns = match places.len() {
            0..=3 => 1,
            4..=8 => 2,
            _ => MOST_COLUMNS,
        };
        let height = [110.0, 84.0, 62.0][columns - 1];
        for row in places.chunks(columns) {
            self.draw_names(row, columns);
            for (column, &place) in row.iter().enumerate() {
                let chart = self.chart(place, column, columns, height);
                self.draw_frame(&chart, true);
                for series in 0..self.panels.series.len() {
                    let drawn = self.plot.series(&chart, place, series, line(series));
                    self.elements.extend(drawn);
                }
            }
            self.bottom += height + X_NUMBERS + 4.0;
        }
    }

    /// Draws a row of panels for each series, with a column for each place.
    fn draw_apart(&mut self) {
        let (places, all) = (self.panels.places.len(), self.panels.series.len());
        let columns = places.clamp(1, MOST_COLUMNS);
        let height = [60.0, 52.0, 44.0][columns - 1];
        let places: Vec<usize> = (0..places).collect();
        for block in places.chunks(columns) {
            self.draw_names(block, columns);
            for series in 0..all {
                let name = self.panels.series[series].clone();
                let at = (Y_LABEL + Y_NUMBERS, self.bottom + SMALL);
                self.elements.push(label(at, SMALL, Anchor::Start, name));
                self.bottom += ROW;
                let is_last = series + 1 == all;
                for (column, &place) in block.iter().enumerate() {
                    let chart = self.chart(place, column, columns, height);
                    self.draw_frame(&chart, is_last);
                    self.draw_one(&chart, place, series);
                }
                self.bottom += height + 4.0;
            }
            self.bottom += X_NUMBERS;
        }
    }

    /// Draws a series with all others behind it.
    fn draw_one(&mut self, chart: &Chart, place: usize, series: usize) {
        let faint = Line {
            colour: FAINT,
            width: 0.8,
            dashes: "",
        };
        let others = (0..self.panels.series.len()).filter(|&other| other != series);
        for other in others {
            let drawn = self.plot.behind(chart, place, other, faint);
            self.elements.extend(drawn);
        }
        let drawn = self.plot.series(chart, place, series, line(0));
        self.elements.extend(drawn);
    }

    fn draw_legend(&mut self) {
        let left = Y_LABEL + Y_NUMBERS;
        let mut x = left;
        for (series, name) in self.panels.series.iter().enumerate() {
            let length = 28.0 + width(name, SMALL);
            if x > left && x + length > WIDTH {
                x = left;
                self.bottom += ROW;
            }
            let middle = self.bottom + 0.6 * SMALL;
            self.elements.push(sample((x, middle), 22.0, line(series)));
            let at = (x + 26.0, self.bottom + SMALL);
            self.elements
                .push(label(at, SMALL, Anchor::Start, name.clone()));
            x += length + 14.0;
        }
        self.bottom += ROW + 4.0;
    }

    /// Writes the names of places above their columns.
    fn draw_names(&mut self, places: &[usize], columns: usize) {
        for (column, &place) in places.iter().enumerate() {
            let chart = self.chart(place, column, columns, 0.0);
            let at = (chart.left + chart.width / 2.0, self.bottom + TEXT);
            let name = self.panels.places[place].clone();
            self.elements.push(label(at, TEXT, Anchor::Middle, name));
        }
        self.bottom += ROW + 2.0;
    }

    fn draw_frame(&mut self, chart: &Chart, has_x_labels: bool) {
        let frame = chart.frame(SMALL, has_x_labels, self.plot.y_number());
        self.elements.extend(frame);
    }

    /// Returns the chart of a place in a column, whose top is the present bottom of the sheet.
    fn chart(&self, place: usize, column: usize, columns: usize, height: f64) -> Chart {
        let room = (WIDTH - Y_LABEL - MARGIN) / columns as f64;
        let [x, y] = self.plot.axes(place);
        Chart {
            left: Y_LABEL + room * column as f64 + Y_NUMBERS,
            top: self.bottom,
            width: room - Y_NUMBERS - MARGIN,
            height,
            x,
            y,
        }
    }

    /// Writes the labels of the axes, and returns the drawing.
    fn finish(mut self, name: &str) -> Drawing {
        let [x_label, y_label] = self.plot.labels().map(str::to_owned);
        let middle = (WIDTH + Y_LABEL + Y_NUMBERS) / 2.0;
        let below = (middle, self.bottom + TEXT);
        let left = (TEXT, self.bottom / 2.0);
        self.elements
            .push(label(below, TEXT, Anchor::Middle, x_label));
        self.elements.push(upright(left, TEXT, y_label));
        let height = (self.bottom + TEXT + MARGIN).ceil();
        self.elements
            .insert(0, block(0.0, 0.0, WIDTH, height, PAPER));
        Drawing {
            width: WIDTH as u32,
            height: height as u32,
            title: name.to_owned(),
            definitions: "",
            elements: self.elements,
        }
    }
}

/// Returns the approximate width of a text.
fn width(text: &str, size: f64) -> f64 {
    0.62 * size * text.chars().count() as f64
}

/// Returns the line of a series.
fn line(series: usize) -> Line {
    let (colour, dashes) = LINES[series % LINES.len()];
    Line {
        colour,
        width: 1.4,
        dashes,
    }
}

/// Returns the curve of a series, in the band between `low` and `high`.
pub(super) fn banded(
    chart: &Chart,
    [low, high, curve]: &[Vec<(f64, f64)>; 3],
    line: Line,
) -> Vec<Element> {
    vec![chart.band(low, high, line.colour), chart.curve(curve, line)]
}
