//! Animations as files.

use super::animation::{Animation, FilmError};
use super::{drawing, moving_png, pixels, svg};

impl Animation {
    /// Renders an SVG document, animated if there are several frames.
    pub fn svg(&self) -> String {
        svg::document(&drawing::draw(self))
    }

    /// Renders a PNG file, animated (APNG) if there are several frames.
    ///
    /// # Errors
    /// When the picture is too large.
    pub fn png(&self) -> Result<Vec<u8>, FilmError> {
        let drawing = drawing::draw(self);
        let picture = match drawing.frames.len() {
            1 => pixels::png(&drawing),
            _ => moving_png::png(&drawing),
        };
        picture.map_err(FilmError::Picture)
    }
}
