//! Text as outlines, from an embedded font.

use ab_glyph::{Font, FontRef, OutlineCurve, Point};
use tiny_skia::{Path, PathBuilder};

/// DejaVu Sans, reduced to Latin letters. It is embedded so that pictures are the same on every
/// machine.
const FONT: &[u8] = include_bytes!("../../assets/font/DejaVuSans-latin.ttf");

/// The parsed font.
pub(super) struct Glyphs(FontRef<'static>);

impl Glyphs {
    /// Parses the font.
    ///
    /// # Errors
    /// When the font cannot be parsed.
    pub fn new() -> Result<Self, String> {
        let font = FontRef::try_from_slice(FONT).map_err(|fault| fault.to_string())?;
        Ok(Self(font))
    }

    /// Returns the outline of a text that begins at `at` on its baseline; `None` if the outline is
    /// empty.
    pub fn outline(&self, text: &str, at: (f32, f32), size: f32) -> Option<Path> {
        let font = &self.0;
        let scale = size / font.units_per_em()?;
        let mut path = PathBuilder::new();
        let mut x = at.0;
        for letter in text.chars() {
            let glyph = font.glyph_id(letter);
            let place = |p: Point| (x + p.x * scale, at.1 - p.y * scale);
            if let Some(outline) = font.outline(glyph) {
                add(&mut path, &outline.curves, place);
            }
            x += font.h_advance_unscaled(glyph) * scale;
        }
        path.finish()
    }
}

/// Adds the curves of a glyph. A curve that does not start where the last one ended starts a new
/// contour.
fn add(path: &mut PathBuilder, curves: &[OutlineCurve], place: impl Fn(Point) -> (f32, f32)) {
    let mut end = None;
    for curve in curves {
        let (first, last) = match *curve {
            OutlineCurve::Line(a, b) => (a, b),
            OutlineCurve::Quad(a, _, c) => (a, c),
            OutlineCurve::Cubic(a, _, _, d) => (a, d),
        };
        if end != Some(first) {
            let (x, y) = place(first);
            path.move_to(x, y);
        }
        end = Some(last);
        let (x, y) = place(last);
        match *curve {
            OutlineCurve::Line(..) => path.line_to(x, y),
            OutlineCurve::Quad(_, b, _) => {
                let (bx, by) = place(b);
                path.quad_to(bx, by, x, y);
            }
            OutlineCurve::Cubic(_, b, c, _) => {
                let ((bx, by), (cx, cy)) = (place(b), place(c));
                path.cubic_to(bx, by, cx, cy, x, y);
            }
        }
    }
}
