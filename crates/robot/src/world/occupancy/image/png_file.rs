//! PNG images.

use super::{Take, check_size, pixel};

/// The largest size in bytes of an unpacked interlaced PNG, which cannot be read row by row.
const MAX_INTERLACED: usize = 256 << 20;

/// Reads a PNG of any colour type.
pub(super) fn read(bytes: &[u8], take: Take<'_>) -> Result<[usize; 2], String> {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|fault| fault.to_string())?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    check_size(width, height)?;
    let (colour, depth) = reader.output_color_type();
    let (colours, has_alpha) = channels(colour)?;
    let wide = depth == png::BitDepth::Sixteen;
    let mut row = |samples: &[u8]| {
        let each = (colours + usize::from(has_alpha)) * if wide { 2 } else { 1 };
        samples
            .chunks_exact(each)
            .for_each(|samples| take(pixel(samples, colours, wide)));
    };
    if !reader.info().interlaced {
        while let Some(samples) = reader.next_row().map_err(|fault| fault.to_string())? {
            row(samples.data());
        }
        return Ok([width, height]);
    }
    let size = reader.output_buffer_size();
    let size = size.filter(|&size| size <= MAX_INTERLACED).ok_or_else(|| {
        format!("it is interlaced and unpacks to more than {MAX_INTERLACED} bytes")
    })?;
    let mut samples = vec![0; size];
    let frame = reader
        .next_frame(&mut samples)
        .map_err(|fault| fault.to_string())?;
    row(&samples[..frame.buffer_size()]);
    Ok([width, height])
}

/// Returns the number of colours of a pixel, and whether it has an opacity.
fn channels(of: png::ColorType) -> Result<(usize, bool), String> {
    match of {
        png::ColorType::Grayscale => Ok((1, false)),
        png::ColorType::GrayscaleAlpha => Ok((1, true)),
        png::ColorType::Rgb => Ok((3, false)),
        png::ColorType::Rgba => Ok((3, true)),
        png::ColorType::Indexed => Err("its palette cannot be read".to_owned()),
    }
}
