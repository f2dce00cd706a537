//! BMP images without compression: 1, 4 or 8 bits a pixel with a palette, or 24 bits.

use super::{Pixel, Take, check_size, pixel};

/// The positions of the fields, in bytes.
const START: usize = 10;
const HEADER: usize = 14;
const WIDTH: usize = 18;
const HEIGHT: usize = 22;
const BITS: usize = 28;
const COMPRESSION: usize = 30;
const COLOURS: usize = 46;
/// The size in bytes of the shortest header with these fields.
const LEAST_HEADER: u32 = 40;

/// Reads an image, and returns width and height.
pub(super) fn read(bytes: &[u8], take: Take<'_>) -> Result<[usize; 2], String> {
    let field = |at: usize| {
        let field = bytes
            .get(at..at + 4)
            .and_then(|field| field.try_into().ok());
        field
            .map(u32::from_le_bytes)
            .ok_or_else(|| "its header is too short".to_owned())
    };
    let refuse = |what: &str| Err(format!("{what}: save it with 24 bits a pixel, or as PNG"));
    let (header, bits) = (field(HEADER)?, field(BITS)? as u16);
    if header < LEAST_HEADER {
        return refuse("it is a BMP of OS/2");
    }
    if field(COMPRESSION)? != 0 {
        return refuse("it is a compressed BMP, or one with masks");
    }
    if !matches!(bits, 1 | 4 | 8 | 24) {
        return refuse(&format!("it is a BMP of {bits} bits a pixel"));
    }
    // The rows are stored upward, unless the height is negative.
    let stored_height = field(HEIGHT)? as i32;
    let [width, height] = [field(WIDTH)?, stored_height.unsigned_abs()].map(|side| side as usize);
    check_size(width, height)?;
    let palette = match bits {
        24 => Vec::new(),
        _ => palette(bytes, HEADER + header as usize, field(COLOURS)?, bits)?,
    };
    let row_bytes = (width * usize::from(bits)).div_ceil(32) * 4;
    let rows = bytes.get(field(START)? as usize..).unwrap_or_default();
    let wanted = row_bytes * height;
    let rows = rows.get(..wanted).ok_or_else(|| {
        let found = rows.len();
        format!("it ends after {found} of the {wanted} bytes of its pixels")
    })?;
    for row in 0..height {
        let stored = if stored_height < 0 {
            row
        } else {
            height - 1 - row
        };
        let samples = &rows[stored * row_bytes..][..row_bytes];
        for col in 0..width {
            take(match bits {
                24 => pixel(&samples[3 * col..][..3], 3, false),
                _ => {
                    let number = number_at(samples, col, usize::from(bits));
                    let colour = palette.get(number);
                    *colour.ok_or_else(|| format!("its palette has no colour {number}"))?
                }
            });
        }
    }
    Ok([width, height])
}

/// Reads a palette of `count` colours; 0 stands for as many as the bits can number.
fn palette(bytes: &[u8], start: usize, count: u32, bits: u16) -> Result<Vec<Pixel>, String> {
    let most = 1 << bits;
    let count = if count == 0 { most } else { count.min(most) } as usize;
    let colours = bytes.get(start..).and_then(|rest| rest.get(..4 * count));
    let colours = colours.ok_or("its palette is too short")?.chunks_exact(4);
    Ok(colours
        .map(|colour| pixel(&colour[..3], 3, false))
        .collect())
}

/// Returns the number in a column of a row of packed numbers, the first in the highest bits.
fn number_at(row: &[u8], col: usize, bits: usize) -> usize {
    let per_byte = 8 / bits;
    let shift = 8 - bits * (col % per_byte + 1);
    usize::from(row[col / per_byte] >> shift) & ((1 << bits) - 1)
}
