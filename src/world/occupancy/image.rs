//! The image of a map: PGM (P2, P5) or PNG.

use std::path::Path;

use super::MapError;
use crate::disk;

/// The largest image file, in bytes.
const MAX_BYTES: u64 = 256 << 20;
/// The most pixels.
const MAX_PIXELS: usize = 1 << 26;

/// Grey levels, row by row from the top.
#[derive(Debug)]
pub(super) struct Image {
    pub width: usize,
    pub height: usize,
    pub greys: Vec<u8>,
    /// By pixel: is it opaque? Empty where all are.
    opaque: Vec<bool>,
}

impl Image {
    /// Reads an image, whatever its name ends in.
    pub fn load(path: &Path) -> Result<Self, MapError> {
        let bytes = disk::read(path, MAX_BYTES).map_err(|cause| MapError::Unreadable {
            path: path.to_owned(),
            cause,
        })?;
        let image = match bytes.get(..2) {
            Some(b"P2") => plain_pgm(&bytes),
            Some(b"P5") => raw_pgm(&bytes),
            Some(b"\x89P") => of_png(&bytes),
            _ => Err("it is neither PGM (P2 or P5) nor PNG".to_owned()),
        };
        image.map_err(|fault| MapError::Image {
            path: path.to_owned(),
            fault,
        })
    }

    /// Is the pixel opaque?
    pub fn is_opaque(&self, at: usize) -> bool {
        self.opaque.get(at).is_none_or(|&opaque| opaque)
    }
}

/// The numbers of a PGM file, which comments may interrupt.
struct Numbers<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Numbers<'a> {
    /// Begins after the two letters.
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

    /// White space, and comments to the ends of their lines.
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

    /// Width, height, and the greatest grey level.
    fn header(&mut self) -> Result<[usize; 3], String> {
        let [width, height, most] = [self.next()?, self.next()?, self.next()?];
        check_size(width, height)?;
        match most {
            1..=65_535 => Ok([width, height, most]),
            _ => Err(format!(
                "the greatest grey level is {most}, but must be from 1 to 65535"
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
        Some(0) => Err("it has no pixel".to_owned()),
        Some(_) => Ok(()),
    }
}

/// A grey level as one of 256.
fn of_256(level: usize, most: usize) -> Result<u8, String> {
    match level <= most {
        true => Ok(((level * 255 + most / 2) / most) as u8),
        false => Err(format!(
            "a grey level is {level}, above the greatest, {most}"
        )),
    }
}

/// PGM in decimal numbers.
fn plain_pgm(bytes: &[u8]) -> Result<Image, String> {
    let mut numbers = Numbers::new(bytes);
    let [width, height, most] = numbers.header()?;
    // Each level takes two bytes of the file: a lie in the header allocates nothing.
    let few = (width * height).min(bytes.len());
    let mut greys = Vec::with_capacity(few);
    for _ in 0..width * height {
        greys.push(of_256(numbers.next()?, most)?);
    }
    let opaque = Vec::new();
    Ok(Image {
        width,
        height,
        greys,
        opaque,
    })
}

/// PGM in bytes, one or two a level.
fn raw_pgm(bytes: &[u8]) -> Result<Image, String> {
    let mut numbers = Numbers::new(bytes);
    let [width, height, most] = numbers.header()?;
    let each = if most > 255 { 2 } else { 1 };
    let wanted = width * height * each;
    let levels = bytes.get(numbers.at + 1..).unwrap_or_default();
    let levels = levels.get(..wanted).ok_or_else(|| {
        let found = levels.len();
        format!("it ends after {found} of the {wanted} bytes of its pixels")
    })?;
    let level = |chunk: &[u8]| {
        chunk
            .iter()
            .fold(0, |sum, &byte| sum << 8 | usize::from(byte))
    };
    let greys: Result<_, _> = levels
        .chunks_exact(each)
        .map(|c| of_256(level(c), most))
        .collect();
    let (greys, opaque) = (greys?, Vec::new());
    Ok(Image {
        width,
        height,
        greys,
        opaque,
    })
}

/// PNG of any colour type; colours count as the mean of their channels, as in Nav2.
fn of_png(bytes: &[u8]) -> Result<Image, String> {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|fault| fault.to_string())?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    check_size(width, height)?;
    let size = reader.output_buffer_size().ok_or("it is too large")?;
    // It is there up to four times on its way to a world.
    let most = disk::room_for(bytes.len() as u64) / 4;
    if size as u64 > most {
        return Err(format!(
            "it unpacks to {size} bytes, but at most {most} are accepted for a file of its size"
        ));
    }
    let mut samples = vec![0; size];
    let frame = reader
        .next_frame(&mut samples)
        .map_err(|fault| fault.to_string())?;
    let (colours, has_alpha) = channels(frame.color_type)?;
    let each = colours + usize::from(has_alpha);
    let pixels = || samples[..frame.buffer_size()].chunks_exact(each);
    let opaque = match has_alpha {
        true => pixels().map(|pixel| pixel[colours] == u8::MAX).collect(),
        false => Vec::new(),
    };
    Ok(Image {
        width,
        height,
        greys: pixels().map(|pixel| mean(&pixel[..colours])).collect(),
        opaque,
    })
}

/// How many colours a pixel has, and whether it tells besides how opaque it is.
fn channels(of: png::ColorType) -> Result<(usize, bool), String> {
    match of {
        png::ColorType::Grayscale => Ok((1, false)),
        png::ColorType::GrayscaleAlpha => Ok((1, true)),
        png::ColorType::Rgb => Ok((3, false)),
        png::ColorType::Rgba => Ok((3, true)),
        png::ColorType::Indexed => Err("its palette cannot be read".to_owned()),
    }
}

fn mean(colours: &[u8]) -> u8 {
    let sum: usize = colours.iter().map(|&colour| usize::from(colour)).sum();
    ((sum + colours.len() / 2) / colours.len()) as u8
}
