//! Drawings as pixels.

use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform,
};

use super::glyphs::Glyphs;
use super::shapes::{Colour, Drawing, Shape};

/// Scale of still pictures, for high-resolution screens.
const STILL_SCALE: f32 = 2.0;

/// Renders the only frame as a PNG file.
///
/// # Errors
/// When the picture is too large.
pub(super) fn png(drawing: &Drawing) -> Result<Vec<u8>, String> {
    encoded(&paint(drawing, 0, STILL_SCALE)?)
}

/// Encodes an opaque picture as a PNG file.
///
/// # Errors
/// When the picture is too large.
pub(super) fn encoded(picture: &Pixmap) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let opaque: Vec<u8> = picture
        .data()
        .chunks_exact(4)
        .flat_map(|p| [p[0], p[1], p[2]])
        .collect();
    let mut writer = encoder.write_header().map_err(|fault| fault.to_string())?;
    writer
        .write_image_data(&opaque)
        .map_err(|fault| fault.to_string())?;
    writer.finish().map_err(|fault| fault.to_string())?;
    Ok(bytes)
}

/// Paints a frame. Every pixel is opaque.
///
/// # Errors
/// When the picture is too large.
pub(super) fn paint(drawing: &Drawing, frame: usize, scale: f32) -> Result<Pixmap, String> {
    let glyphs = Glyphs::new()?;
    let length = |pixels: u32| (pixels as f32 * scale) as u32;
    let (width, height) = (length(drawing.width), length(drawing.height));
    let mut canvas = Pixmap::new(width, height)
        .ok_or_else(|| format!("{width} x {height} pixels are too many"))?;
    for shape in drawing.shapes(frame) {
        let look = Transform::from_scale(scale, scale);
        add(&mut canvas, shape, look, &glyphs);
    }
    Ok(canvas)
}

fn add(canvas: &mut Pixmap, shape: &Shape, look: Transform, glyphs: &Glyphs) {
    match shape {
        Shape::Rect { fill, .. } => {
            if let Some(rect) = rect(shape) {
                canvas.fill_rect(rect, &paint_of(*fill), look, None);
            }
        }
        Shape::Line {
            points,
            width,
            colour,
        } => {
            if let Some(path) = path(points) {
                let stroke = round(*width as f32);
                canvas.stroke_path(&path, &paint_of(*colour), &stroke, look, None);
            }
        }
        Shape::Arrow {
            tail,
            heading,
            length,
            fill,
        } => {
            let outline = path(&heading.outline(*tail, *length));
            fill_path(canvas, outline, *fill, look);
        }
        Shape::Text {
            at,
            size,
            colour,
            text,
        } => {
            let at = (at.0 as f32, at.1 as f32);
            fill_path(
                canvas,
                glyphs.outline(text, at, *size as f32),
                *colour,
                look,
            );
        }
    }
}

fn rect(shape: &Shape) -> Option<Rect> {
    let Shape::Rect {
        left,
        top,
        width,
        height,
        ..
    } = shape
    else {
        return None;
    };
    let [x, y, w, h] = [left, top, width, height].map(|&length| length as f32);
    Rect::from_xywh(x, y, w, h)
}

/// Returns a stroke with round ends and joins.
fn round(width: f32) -> Stroke {
    Stroke {
        width,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Stroke::default()
    }
}

fn fill_path(canvas: &mut Pixmap, outline: Option<Path>, fill: Colour, look: Transform) {
    if let Some(outline) = outline {
        canvas.fill_path(&outline, &paint_of(fill), FillRule::Winding, look, None);
    }
}

/// Returns a path through points; `None` if it has no extent.
fn path(points: &[(f64, f64)]) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (number, (x, y)) in points.iter().enumerate() {
        match number {
            0 => path.move_to(*x as f32, *y as f32),
            _ => path.line_to(*x as f32, *y as f32),
        }
    }
    path.finish()
}

fn paint_of(Colour(red, green, blue): Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}
