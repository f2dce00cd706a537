//! Netpbm images: PBM (P1, P4), PGM (P2, P5) and PPM (P3, P6).

use super::{Pixel, Take, check_size};

/// A file, read from front to back; comments may be anywhere in its text.
struct Text<'a> {
    bytes: &'a [u8],
    at: usize,
}

/// The header of a file.
struct Header {
    width: usize,
    height: usize,
    /// The largest level of a channel.
    most: usize,
}

impl<'a> Text<'a> {
    /// Starts after the two letters of the file type.
    fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 2 }
    }

    /// Reads a decimal number.
    fn number(&mut self) -> Result<usize, String> {
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

    /// Reads one digit, 0 or 1; no white space is needed around it.
    fn bit(&mut self) -> Result<bool, String> {
        self.skip();
        let bit = match self.bytes.get(self.at) {
            Some(b'0') => Ok(false),
            Some(b'1') => Ok(true),
            _ => Err(format!("expected 0 or 1 at byte {}", self.at)),
        };
        self.at += 1;
        bit
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

    /// Reads width, height, and the largest level, which a bitmap has not.
    fn header(&mut self, is_bitmap: bool) -> Result<Header, String> {
        let [width, height] = [self.number()?, self.number()?];
        check_size(width, height)?;
        let most = if is_bitmap { 1 } else { self.number()? };
        match most {
            1..=65_535 => Ok(Header {
                width,
                height,
                most,
            }),
            _ => Err(format!(
                "the maximum level is {most}, but must be from 1 to 65535"
            )),
        }
    }

    /// Returns the bytes of raw pixels, one white space after the header.
    fn raw(&self, wanted: usize) -> Result<&'a [u8], String> {
        let bytes = self.bytes.get(self.at + 1..).unwrap_or_default();
        bytes.get(..wanted).ok_or_else(|| {
            let found = bytes.len();
            format!("it ends after {found} of the {wanted} bytes of its pixels")
        })
    }
}

/// Reads an image, and returns width and height.
pub(super) fn read(bytes: &[u8], take: Take<'_>) -> Result<[usize; 2], String> {
    let mut text = Text::new(bytes);
    let kind = bytes[1];
    let header = text.header(matches!(kind, b'1' | b'4'))?;
    let (pixels, most) = (header.width * header.height, header.most);
    let channels = if matches!(kind, b'3' | b'6') { 3 } else { 1 };
    match kind {
        b'1' => {
            for _ in 0..pixels {
                take(black_if(text.bit()?));
            }
        }
        b'4' => {
            let row_bytes = header.width.div_ceil(8);
            for row in text.raw(row_bytes * header.height)?.chunks_exact(row_bytes) {
                let bits = (0..header.width).map(|col| row[col / 8] << (col % 8) & 0x80 != 0);
                bits.for_each(|bit| take(black_if(bit)));
            }
        }
        b'2' | b'3' => {
            let mut levels = [0; 3];
            for _ in 0..pixels {
                for level in &mut levels[..channels] {
                    *level = text.number()?;
                }
                take(scaled(&levels[..channels], most)?);
            }
        }
        _ => {
            let wide = most > 255;
            let each = if wide { 2 * channels } else { channels };
            let mut levels = [0; 3];
            for bytes in text.raw(pixels * each)?.chunks_exact(each) {
                for (level, bytes) in levels.iter_mut().zip(bytes.chunks(each / channels)) {
                    *level = bytes
                        .iter()
                        .fold(0, |sum, &byte| sum << 8 | usize::from(byte));
                }
                take(scaled(&levels[..channels], most)?);
            }
        }
    }
    Ok([header.width, header.height])
}

fn black_if(is_black: bool) -> Pixel {
    Pixel {
        colours: if is_black { 0 } else { 3 * 65_535 },
        alpha: None,
    }
}

/// Returns the pixel for one or three levels.
fn scaled(levels: &[usize], most: usize) -> Result<Pixel, String> {
    let mut sum = 0;
    for &level in levels {
        if level > most {
            return Err(format!("the level {level} exceeds the maximum, {most}"));
        }
        sum += (level * 65_535 + most / 2) / most;
    }
    Ok(Pixel {
        colours: (sum * 3 / levels.len()) as u32,
        alpha: None,
    })
}
