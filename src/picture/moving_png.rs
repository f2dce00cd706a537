//! Drawings as animated PNG files.

use std::io::Write;

use png::{BlendOp, DisposeOp, EncodingError, Writer};

use super::pixels;
use super::shapes::{Drawing, FRAME_MS, LAST_FRAME_MS};

/// Renders an animated PNG of all frames. After the first frame, only the changes are written.
///
/// # Errors
/// When the picture is too large.
pub(super) fn png(drawing: &Drawing) -> Result<Vec<u8>, String> {
    let frames: Result<Vec<Vec<u8>>, String> = (0..drawing.frames.len())
        .map(|frame| Ok(pixels::paint(drawing, frame, 1.0)?.data().to_vec()))
        .collect();
    let mut bytes = Vec::new();
    write(&mut bytes, drawing, &frames?).map_err(|fault| fault.to_string())?;
    Ok(bytes)
}

fn write(bytes: &mut Vec<u8>, drawing: &Drawing, frames: &[Vec<u8>]) -> Result<(), EncodingError> {
    let (width, height) = (drawing.width, drawing.height);
    let mut encoder = png::Encoder::new(bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_compression(png::Compression::High);
    // Unchanged pixels are all zeros, and a filter would make them harder to compress.
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_animated(frames.len() as u32, 0)?;
    encoder.set_dispose_op(DisposeOp::None)?;
    encoder.set_blend_op(BlendOp::Over)?;
    let mut writer = encoder.write_header()?;
    for (number, frame) in frames.iter().enumerate() {
        let is_last = number + 1 == frames.len();
        let lasts_ms = if is_last { LAST_FRAME_MS } else { FRAME_MS };
        writer.set_frame_delay(lasts_ms as u16, 1000)?;
        match number.checked_sub(1) {
            None => writer.write_image_data(frame)?,
            Some(before) => write_change(&mut writer, &frames[before], frame, width)?,
        }
    }
    writer.finish()
}

/// Writes the bounding rectangle of all changes. Unchanged pixels in it are transparent.
fn write_change(
    writer: &mut Writer<impl Write>,
    before: &[u8],
    now: &[u8],
    width: u32,
) -> Result<(), EncodingError> {
    let row_bytes = 4 * width as usize;
    let changed = Area::of_changes(before, now, row_bytes);
    writer.reset_frame_position()?;
    writer.set_frame_dimension(changed.width, changed.height)?;
    writer.set_frame_position(changed.left, changed.top)?;
    let mut pixels = Vec::new();
    for row in changed.top..changed.top + changed.height {
        let start = row as usize * row_bytes + 4 * changed.left as usize;
        let range = start..start + 4 * changed.width as usize;
        let pairs = before[range.clone()]
            .chunks_exact(4)
            .zip(now[range].chunks_exact(4));
        for (old, new) in pairs {
            pixels.extend_from_slice(if old == new { &[0; 4] } else { new });
        }
    }
    writer.write_image_data(&pixels)
}

/// A non-empty rectangle of pixels.
struct Area {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
}

impl Area {
    /// Returns the smallest area that contains all pixels in which two pictures differ.
    fn of_changes(before: &[u8], now: &[u8], row_bytes: usize) -> Self {
        let (mut left, mut right, mut top, mut bottom) = (u32::MAX, 0, u32::MAX, 0);
        let rows = before
            .chunks_exact(row_bytes)
            .zip(now.chunks_exact(row_bytes));
        for (row, (old, new)) in (0..).zip(rows) {
            let pixels = old.chunks_exact(4).zip(new.chunks_exact(4));
            for (col, _) in (0..).zip(pixels).filter(|(_, (a, b))| a != b) {
                (left, right) = (left.min(col), right.max(col));
                (top, bottom) = (top.min(row), bottom.max(row));
            }
        }
        if top > bottom {
            (left, right, top, bottom) = (0, 0, 0, 0);
        }
        Self {
            left,
            top,
            width: right - left + 1,
            height: bottom - top + 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_of_changes_holds_every_pixel_that_differs() {
        let before = vec![0; 4 * 5 * 4];
        let mut now = before.clone();
        (now[4 * (5 + 2)], now[4 * (2 * 5 + 3) + 1]) = (9, 9);
        let area = Area::of_changes(&before, &now, 4 * 5);
        assert_eq!((area.left, area.top, area.width, area.height), (2, 1, 2, 2));
        let none = Area::of_changes(&before, &before, 4 * 5);
        assert_eq!((none.width, none.height), (1, 1));
    }
}
