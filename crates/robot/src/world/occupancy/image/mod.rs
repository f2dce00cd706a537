//! The image of a map: BMP, JPEG, Netpbm or PNG.

mod bmp;
mod jpeg;
mod netpbm;
mod png_file;

use std::path::Path;

use super::MapError;
use super::rules::Pixel;
use crate::input;

/// The largest image file, in bytes.
const MAX_BYTES: u64 = 256 << 20;
/// The largest number of pixels: a square of 400 m at 5 cm. A conversion needs about 14 bytes per
/// pixel.
const MAX_PIXELS: usize = 64_000_000;
/// The longest side of an image, in pixels.
const MAX_SIDE: usize = 65_536;

/// Receives the pixels of an image, row by row from the top.
pub(super) type Take<'a> = &'a mut dyn FnMut(Pixel);

/// Reads an image of any file extension, and returns width and height.
pub(super) fn read(path: &Path, take: Take<'_>) -> Result<[usize; 2], MapError> {
    let bytes = input::read(path, MAX_BYTES).map_err(|cause| MapError::Unreadable {
        path: path.to_owned(),
        cause,
    })?;
    let size = match bytes.get(..2) {
        Some([b'P', b'1'..=b'6']) => netpbm::read(&bytes, take),
        Some(b"\x89P") => png_file::read(&bytes, take),
        Some(b"BM") => bmp::read(&bytes, take),
        Some(b"\xff\xd8") => jpeg::read(&bytes, take),
        _ => Err(
            "it is neither PGM, PPM, PNG, BMP nor JPEG: convert it with an image editor, and name the new file in `image`"
                .to_owned(),
        ),
    };
    size.map_err(|fault| MapError::Image {
        path: path.to_owned(),
        fault,
    })
}

/// Checks the size that an image declares, before its pixels are unpacked.
fn check_size(width: usize, height: usize) -> Result<(), String> {
    if let Some(side) = [width, height].into_iter().find(|&side| side > MAX_SIDE) {
        return Err(format!("a side of {side} pixels is longer than {MAX_SIDE}"));
    }
    match width * height {
        0 => Err("it has no pixels".to_owned()),
        pixels if pixels > MAX_PIXELS => Err(format!(
            "{width} x {height} pixels are more than {MAX_PIXELS}"
        )),
        _ => Ok(()),
    }
}

/// Returns a pixel with one or three colours, and perhaps an opacity, of one or two bytes each.
fn pixel(samples: &[u8], colours: usize, wide: bool) -> Pixel {
    let level = |number: usize| match wide {
        true => u32::from(u16::from_be_bytes([
            samples[2 * number],
            samples[2 * number + 1],
        ])),
        false => u32::from(samples[number]) * 257,
    };
    let count = samples.len() / if wide { 2 } else { 1 };
    let sum: u32 = (0..colours).map(level).sum();
    Pixel {
        colours: sum * 3 / colours as u32,
        alpha: (count > colours).then(|| level(colours)),
    }
}
