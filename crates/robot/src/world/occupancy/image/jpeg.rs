//! JPEG images, which are unpacked as a whole: at most three bytes a pixel.

use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

use super::{MAX_SIDE, Take, check_size, pixel};

/// Damaged files are refused instead of filled with grey.
fn options() -> DecoderOptions {
    DecoderOptions::new_safe()
        .set_strict_mode(true)
        .set_max_width(MAX_SIDE)
        .set_max_height(MAX_SIDE)
}

/// Reads a grey or coloured image.
pub(super) fn read(bytes: &[u8], take: Take<'_>) -> Result<[usize; 2], String> {
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options());
    decoder
        .decode_headers()
        .map_err(|fault| fault.to_string())?;
    let info = decoder.info().ok_or("it has no size")?;
    let [width, height] = [info.width, info.height].map(usize::from);
    check_size(width, height)?;
    let (channels, wanted) = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => (1, ColorSpace::Luma),
        Some(ColorSpace::YCbCr | ColorSpace::RGB) => (3, ColorSpace::RGB),
        _ => return Err("its colours are neither grey nor RGB: save it as PNG".to_owned()),
    };
    decoder.set_options(options().jpeg_set_out_colorspace(wanted));
    let samples = decoder.decode().map_err(|fault| fault.to_string())?;
    if samples.len() != channels * width * height {
        return Err("it does not have as many pixels as it declares".to_owned());
    }
    let pixels = samples.chunks_exact(channels);
    pixels.for_each(|samples| take(pixel(samples, channels, false)));
    Ok([width, height])
}
