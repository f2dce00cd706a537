//! Sizes, fonts and colours that all figures share.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Colours that colour-blind people can distinguish (Okabe and Ito 2008), the plain ones first.
const COLOURS: [RGBColor; 8] = [
    RGBColor(90, 90, 90),
    RGBColor(86, 180, 233),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
];

/// Maximum number of series with different colours.
pub const MOST_SERIES: usize = COLOURS.len();
/// Text anchored at its centre.
pub const CENTRED: Pos = Pos {
    h_pos: HPos::Center,
    v_pos: VPos::Center,
};
/// Text anchored at the middle of its left end.
pub const FROM_LEFT: Pos = Pos {
    h_pos: HPos::Left,
    v_pos: VPos::Center,
};
/// The colour of text and axes.
pub const INK: RGBColor = RGBColor(34, 34, 34);
/// The colour of grid lines.
pub const FAINT: RGBColor = RGBColor(225, 225, 225);

/// Returns the text style of this size.
pub fn text(size: u32) -> TextStyle<'static> {
    ("sans-serif", size).into_font().color(&INK)
}

/// Returns the line style of this colour and width.
pub fn line(colour: impl Into<RGBAColor>, width: u32) -> ShapeStyle {
    ShapeStyle {
        color: colour.into(),
        filled: false,
        stroke_width: width,
    }
}

/// Returns the approximate width of the longest name in small text.
pub fn widest(names: &[String]) -> i32 {
    let letters = names.iter().map(|name| name.chars().count()).max();
    7 * letters.unwrap_or(0) as i32
}

/// Returns the colour of a series.
pub fn colour(series: usize) -> RGBColor {
    COLOURS[series % COLOURS.len()]
}

/// Returns round ticks for an axis of episodes: at most seven, starting at 0.
pub fn ticks(episodes: u32) -> Vec<u32> {
    let step = [1, 2, 5, 10, 20, 30, 50, 100, 200, 500]
        .into_iter()
        .find(|step| episodes / step <= 6)
        .unwrap_or(episodes / 5);
    (0..=episodes / step).map(|tick| tick * step).collect()
}
