//! Drawings as animated PNG files.

use png::{BlendOp, DisposeOp, EncodingError};

use super::pixels;
use super::svg::{Drawing, FRAME_MS, LAST_FRAME_MS};

/// Renders an animated PNG of all frames. After the first frame, only the changes are written.
///
/// # Errors
/// When the picture is too large.
pub(super) fn png(drawing: &Drawing) -> Result<Vec<u8>, String> {
    let frames = drawing.frames.chunks(1);
    let frames = frames.map(|frame| pixels::rendered(&drawing.document_of(frame), 1.0));
    let frames: Result<Vec<Vec<u8>>, String> = frames.map(|frame| Ok(frame?.take())).collect();
    let mut bytes = Vec::new();
    write(&mut bytes, drawing, &frames?).map_err(|fault| fault.to_string())?;
    Ok(bytes)
}

fn write(bytes: &mut Vec<u8>, drawing: &Drawing, frames: &[Vec<u8>]) -> Result<(), EncodingError> {
    let mut encoder = png::Encoder::new(bytes, drawing.width, drawing.height);
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
            Some(before) => writer.write_image_data(&changes(&frames[before], frame))?,
        }
    }
    writer.finish()
}

/// Returns a frame in which the pixels that equal those of the frame before are transparent.
fn changes(before: &[u8], now: &[u8]) -> Vec<u8> {
    let pairs = before.chunks_exact(4).zip(now.chunks_exact(4));
    let changed = pairs.flat_map(|(old, new)| if old == new { &[0; 4] } else { new });
    changed.copied().collect()
}
