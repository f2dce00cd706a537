//! The image of a map: PGM (P2, P5) or PNG.

use std::path::Path;

use super::MapError;
use super::rules::Pixel;
use crate::input;

/// The largest image file, in bytes.
const MAX_BYTES: u64 = 256 << 20;
/// The largest number of pixels: a square of 400 m at 5 cm. A conversion needs about 14 bytes per
/// pixel.
const MAX_PIXELS: usize = 64_000_000;
/// The largest size in bytes of an unpacked interlaced PNG, which cannot be read row by row.
const MAX_INTERLACED: usize = 256 << 20;

/// Receives the pixels of an image, row by row from the top.
pub(super) type Take<'a> = &'a mut dyn FnMut(Pixel);

/// Reads an image of any file extension, and returns width and height.
pub(super) fn read(path: &Path, take: Take<'_>) -> Result<[usize; 2], MapError> {
    let bytes = input::read(path, MAX_BYTES).map_err(|cause| MapError::Unreadable {
        path: path.to_owned(),
        cause,
    })?;
    let size = match bytes.get(..2) {
        Some(b"P2") => plain_pgm(&bytes, take),
        Some(b"P5") => raw_pgm(&bytes, take),
        Some(b"\x89P") => of_png(&bytes, take),
        _ => Err(
            "it is neither PGM (P2 or P5) nor PNG: convert it with an image editor, and name the new file in `image`"
                .to_owned(),
        ),
    };
    size.map_err(|fault| MapError::Image {
        path: path.to_owned(),
        fault,
    })
}

/// The numbers of a PGM file; comments may be anywhere between them.
struct Numbers<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Numbers<'a> {
    /// Starts after the two letters of the file type.
    fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 2 }
    }

    fn next(&mut self) -> Result<usize, String> {
        self.skip();
        let digits = self.bytes[self.at..]
            .iter()
            .take_while(|byte| byte.is_ascii_digit());
        let length = digits.count();
        let text = std::str::from_utf8(&self.bytes[self.at..self.at + length]).unwrap_or_default();
        let number = text
            .parse()
            .map_err(|_| format!("expected a number at byte {}", self.at));
        self.at += length;
        number
    }

    /// Skips white space, and comments to the ends of their lines.
    fn skip(&mut self) {
        while let Some(byte) = self.bytes.get(self.at) {
            match byte {
                b'#' => {
                    let rest = self.bytes[self.at..].iter();
                    self.at += rest.take_while(|&&byte| byte != b'\n').count();
                }
                byte if byte.is_ascii_whitespace() => self.at += 1,
                _ => return,
            }
        }
    }

    /// Returns width, height, and the largest grey level.
    fn header(&mut self) -> Result<[usize; 3], String> {
        let [width, height, most] = [self.next()?, self.next()?, self.next()?];
        check_size(width, height)?;
        match most {
            1..=65_535 => Ok([width, height, most]),
            _ => Err(format!(
                "the maximum grey level is {most}, but must be from 1 to 65535"
            )),
        }
    }
}

fn check_size(width: usize, height: usize) -> Result<(), String> {
    let pixels = width
        .checked_mul(height)
        .filter(|&pixels| pixels <= MAX_PIXELS);
    match pixels {
        None => Err(format!(
            "{width} x {height} pixels are more than {MAX_PIXELS}"
        )),
        Some(0) => Err("it has no pixels".to_owned()),
        Some(_) => Ok(()),
    }
}

/// Returns the pixel for a grey level.
fn grey(level: usize, most: usize) -> Result<Pixel, String> {
    match level <= most {
        true => Ok(Pixel {
            colours: 3 * ((level * 65_535 + most / 2) / most) as u32,
            alpha: None,
        }),
        false => Err(format!(
            "the grey level {level} exceeds the maximum, {most}"
        )),
    }
}

/// Reads a PGM with decimal numbers.
fn plain_pgm(bytes: &[u8], take: Take<'_>) -> Result<[usize; 2], String> {
    let mut numbers = Numbers::new(bytes);
    let [width, height, most] = numbers.header()?;
    for _ in 0..width * height {
        take(grey(numbers.next()?, most)?);
    }
    Ok([width, height])
}

/// Reads a PGM with one or two bytes per grey level.
fn raw_pgm(bytes: &[u8], take: Take<'_>) -> Result<[usize; 2], String> {
    let mut numbers = Numbers::new(bytes);
    let [width, height, most] = numbers.header()?;
    let each = if most > 255 { 2 } else { 1 };
    let wanted = width * height * each;
    let levels = bytes.get(numbers.at + 1..).unwrap_or_default();
    let levels = levels.get(..wanted).ok_or_else(|| {
        let found = levels.len();
        format!("it ends after {found} of the {wanted} bytes of its pixels")
    })?;
    for level in levels.chunks_exact(each) {
        let level = level
            .iter()
            .fold(0, |sum, &byte| sum << 8 | usize::from(byte));
        take(grey(level, most)?);
    }
    Ok([width, height])
}

/// Reads a PNG of any colour type.
fn of_png(bytes: &[u8], take: Take<'_>) -> Result<[usize; 2], String> {
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
