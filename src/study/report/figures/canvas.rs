//! Renders a drawing as SVG.

use plotters::coord::Shift;
use plotters::coord::ranged1d::Ranged;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;
use plotters::style::text_anchor::Pos;

use super::theme::{CENTRED, FROM_LEFT, colour, line, text};

/// Width and height in pixels.
pub type Size = (i32, i32);

/// The area of a figure, or a part of it.
pub type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A chart in a part of a figure.
pub type Chart<'a, 'b, X, Y> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>;

/// The result of drawing.
pub type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// A figure.
pub trait Drawing {
    /// Returns the size of the figure.
    fn size(&self) -> Size;

    /// Draws the figure.
    fn draw(&self, canvas: &Canvas<'_>) -> Drawn;
}

/// Renders a drawing as an SVG document.
pub fn svg(drawing: &dyn Drawing) -> Result<String, String> {
    let mut text = String::new();
    let (width, height) = drawing.size();
    let size = (width.unsigned_abs(), height.unsigned_abs());
    let canvas = SVGBackend::with_string(&mut text, size).into_drawing_area();
    canvas
        .fill(&WHITE)
        .and_then(|()| drawing.draw(&canvas))
        .and_then(|()| canvas.present())
        .map_err(|fault| fault.to_string())?;
    drop(canvas);
    // Verdana is as wide as DejaVu Sans, in case the latter is not installed.
    let fonts = "font-family=\"DejaVu Sans, Verdana, sans-serif\"";
    Ok(text.replace("font-family=\"sans-serif\"", fonts))
}

/// Writes text of this size, anchored at a position.
pub fn write(canvas: &Canvas<'_>, size: u32, anchor: Pos, at: (i32, i32), words: &str) -> Drawn {
    canvas.draw_text(words, &text(size).pos(anchor), at)
}

/// Writes the title of a figure, and a note under it at a height.
pub fn write_title(
    canvas: &Canvas<'_>,
    middle: i32,
    title: &str,
    note: Option<(i32, &str)>,
) -> Drawn {
    write(canvas, 17, CENTRED, (middle, 18), title)?;
    note.map_or(Ok(()), |(y, note)| {
        write(canvas, 12, CENTRED, (middle, y), note)
    })
}

/// Draws a straight line.
pub fn draw_line(canvas: &Canvas<'_>, ends: [(i32, i32); 2], style: ShapeStyle) -> Drawn {
    canvas.draw(&PathElement::new(ends, style))
}

/// Draws the line and the name of a series at a height, to explain its colour.
pub fn draw_key(canvas: &Canvas<'_>, series: usize, y: i32, name: &str) -> Drawn {
    draw_line(canvas, [(8, y), (28, y)], line(colour(series), 3))?;
    write(canvas, 12, FROM_LEFT, (34, y), name)
}

/// Draws the curve of a series in its band.
pub fn draw_curve<X: Ranged, Y: Ranged>(
    chart: &mut Chart<'_, '_, X, Y>,
    series: usize,
    [low, high, curve]: [Vec<(X::ValueType, Y::ValueType)>; 3],
) -> Drawn
where
    X::ValueType: Clone + 'static,
    Y::ValueType: Clone + 'static,
{
    let hue = colour(series);
    let band: Vec<_> = high.into_iter().chain(low.into_iter().rev()).collect();
    chart.draw_series([Polygon::new(band, hue.mix(0.18).filled())])?;
    chart.draw_series([PathElement::new(curve, line(hue, 2))])?;
    Ok(())
}
