//! From a drawing to SVG and PNG.

use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::*;

use super::theme::Theme;

/// Width and height in pixels.
pub type Size = (u32, u32);

/// What drawing gives.
pub type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// The pixels of a PNG along each pixel of the figure.
const PNG_SCALE: u32 = 2;
/// The pixels drawn along each pixel of a PNG, which smooths edges; [`smoothed`] knows that they are two.
const SMOOTH: u32 = 2;

/// Something that can be drawn on any backend.
pub trait Drawing {
    /// The size of the figure.
    fn size(&self) -> Size;

    /// Draws it.
    fn draw<DB: DrawingBackend>(&self, root: &DrawingArea<DB, Shift>, theme: Theme) -> Drawn<DB>;
}

/// The drawing as an SVG document.
pub fn svg(drawing: &impl Drawing) -> Result<String, String> {
    let mut text = String::new();
    let theme = Theme::new(1)?;
    let root = SVGBackend::with_string(&mut text, drawing.size()).into_drawing_area();
    paint(&root, drawing, theme)?;
    drop(root);
    // Where DejaVu Sans is not installed, these are as wide.
    let fonts = "font-family=\"DejaVu Sans, Verdana, sans-serif\"";
    Ok(text.replace("font-family=\"sans-serif\"", fonts))
}

/// The drawing as a PNG file.
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

/// The mean of each square of 2 x 2 pixels of three bytes, in rows of `stride` bytes. Written out,
/// since it costs most of a figure where it is not optimised.
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
