//! A film as a file.

use super::animation::{Animation, FilmError};
use super::{drawing, moving_png, pixels, svg};

impl Animation {
    /// An SVG document, which moves if there are several moments.
    pub fn svg(&self) -> String {
        svg::document(&drawing::draw(self))
    }

    /// A PNG file, which is an animated one (APNG) if there are several moments.
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
