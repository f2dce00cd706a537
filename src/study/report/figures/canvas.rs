//! Renders a drawing as SVG and PNG.

use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;

use super::theme::Theme;

/// Width and height in pixels.
pub type Size = (u32, u32);

/// The result of drawing.
pub type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// Pixels of a PNG per pixel of the figure, in each direction.
const PNG_SCALE: u32 = 2;
/// Drawn pixels per pixel of a PNG, in each direction, for smooth edges. [`smoothed`] assumes two.
const SMOOTH: u32 = 2;

/// A figure that can be drawn on any backend.
pub trait Drawing {
    /// Returns the size of the figure.
    fn size(&self) -> Size;

    /// Draws the figure.
    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, theme: Theme) -> Drawn<DB>;
}

/// Renders a drawing as an SVG document.
pub fn svg(drawing: &impl Drawing) -> Result<String, String> {
    let mut text = String::new();
    let theme = Theme::new(1)?;
    let root = SVGBackend::with_string(&mut text, drawing.size()).into_drawing_area();
    paint(&root, drawing, theme)?;
    drop(root);
    // Verdana is as wide as DejaVu Sans, in case the latter is not installed.
    let fonts = "font-family=\"DejaVu Sans, Verdana, sans-serif\"";
    Ok(text.replace("font-family=\"sans-serif\"", fonts))
}

/// Renders a drawing as a PNG file.
pub fn png(drawing: &impl Drawing) -> Result<Vec<u8>, String> {
    let theme = Theme::new(PNG_SCALE * SMOOTH)?;
    let (width, height) = drawing.size();
    let (wide, high) = (theme.px(width), theme.px(height));
    let mut pixels = vec![0; wide as usize * high as usize * 3];
    {
        let backend = BitMapBackend::with_buffer(&mut pixels, (wide, high));
        paint(&backend.into_drawing_area(), drawing, theme)?;
    }
    let small = smoothed(&pixels, wide as usize * 3);
    encode(&small, (width * PNG_SCALE, height * PNG_SCALE)).map_err(|fault| fault.to_string())
}

fn paint<DB: DrawingBackend>(
    root: &DrawingArea<DB, Shift>,
    drawing: &impl Drawing,
    theme: Theme,
) -> Result<(), String> {
    let painted = root
        .fill(&WHITE)
        .and_then(|()| drawing.draw(root, theme))
        .and_then(|()| root.present());
    painted.map_err(|fault| fault.to_string())
}

/// Returns the mean of each square of 2 x 2 pixels of three bytes, in rows of `stride` bytes. The
/// sum is written out, because without optimisation it takes most of a figure's time.
fn smoothed(pixels: &[u8], stride: usize) -> Vec<u8> {
    let mut small = Vec::with_capacity(pixels.len() / 4);
    for rows in pixels.chunks_exact(stride * 2) {
        let (upper, lower) = rows.split_at(stride);
        for (a, b) in upper.chunks_exact(6).zip(lower.chunks_exact(6)) {
            let mean = |at: usize| {
                let sum = a[at] as u16 + a[at + 3] as u16 + b[at] as u16 + b[at + 3] as u16;
                (sum / 4) as u8
            };
            small.extend_from_slice(&[mean(0), mean(1), mean(2)]);
        }
    }
    small
}

fn encode(pixels: &[u8], (width, height): Size) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}
