//! SVG documents as pixels.

use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};

/// DejaVu Sans, reduced to Latin letters. It is embedded so that pictures are the same on every
/// machine.
pub(crate) const FONT: &[u8] = include_bytes!("../../assets/font/DejaVuSans-latin.ttf");
/// Scale of still pictures, for high-resolution screens.
const STILL_SCALE: f32 = 2.0;

/// Renders an SVG document as a PNG file for high-resolution screens.
///
/// # Errors
/// When the picture is too large.
pub(crate) fn png(svg: &str) -> Result<Vec<u8>, String> {
    let pixels = rendered(svg, STILL_SCALE)?.encode_png();
    pixels.map_err(|fault| fault.to_string())
}

/// Renders an SVG document.
///
/// # Errors
/// When the picture is too large.
pub(super) fn rendered(svg: &str, scale: f32) -> Result<Pixmap, String> {
    let mut fonts = Database::new();
    fonts.load_font_data(FONT.to_vec());
    let options = Options {
        fontdb: Arc::new(fonts),
        ..Options::default()
    };
    let tree = Tree::from_str(svg, &options).map_err(|fault| fault.to_string())?;
    let length = |pixels: f32| (pixels * scale) as u32;
    let (width, height) = (length(tree.size().width()), length(tree.size().height()));
    let mut pixels = Pixmap::new(width, height)
        .ok_or_else(|| format!("{width} x {height} pixels are too many"))?;
    let scale = Transform::from_scale(scale, scale);
    resvg::render(&tree, scale, &mut pixels.as_mut());
    Ok(pixels)
}
