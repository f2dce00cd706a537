//! Images of all formats that Nav2 reads, each with what it holds.

use png::{BitDepth, ColorType};
use xcscr::xcs::random::Stream;

/// What an image holds of a pixel, as 16-bit channels: red, green, blue, and the opacity.
pub type Channels = ([u16; 3], Option<u16>);

/// A file of an image, and what it holds.
pub struct Image {
    pub what: String,
    pub bytes: Vec<u8>,
    pub pixels: Vec<Channels>,
}

pub const SIDE: usize = 16;

/// A level of so many bits as 16 bits.
pub fn wide(level: u16, bits: u8) -> u16 {
    (u32::from(level) * 65535 / ((1 << bits) - 1)) as u16
}

/// An image of Netpbm: PBM, PGM or PPM.
pub fn netpbm(kind: u8, most: u16, stream: &mut Stream) -> Image {
    let is_plain = kind <= 3;
    let channels = if matches!(kind, 3 | 6) { 3 } else { 1 };
    let is_bitmap = matches!(kind, 1 | 4);
    let draw = |_| stream.below(usize::from(most) + 1) as u16;
    let levels: Vec<u16> = (0..channels * SIDE * SIDE).map(draw).collect();
    let mut bytes = format!("P{kind}\n# drawn\n{SIDE} {SIDE}\n").into_bytes();
    if !is_bitmap {
        bytes.extend(format!("{most}\n").bytes());
    }
    for (at, &level) in levels.iter().enumerate() {
        match (kind, most) {
            // A bit is black if it is set.
            (1, _) => bytes.push(b'1' - level as u8),
            (4, _) if at % 8 == 0 => bytes.push((1 - level as u8) << 7),
            (4, _) => *bytes.last_mut().unwrap() |= (1 - level as u8) << (7 - at % 8),
            _ if is_plain => bytes.extend(format!("{level}\n").bytes()),
            (_, 0..=255) => bytes.push(level as u8),
            _ => bytes.extend(level.to_be_bytes()),
        }
    }
    let full = |level: u16| (f64::from(level) * 65535.0 / f64::from(most)).round() as u16;
    let pixel = |levels: &[u16]| [levels[0], levels[channels / 2], levels[channels - 1]].map(full);
    let pixels = levels.chunks(channels).map(|levels| (pixel(levels), None));
    Image {
        what: format!("P{kind}, up to {most}"),
        bytes,
        pixels: pixels.collect(),
    }
}

/// A BMP of 24 bits a pixel, or of numbers of so many bits in a palette; from the lower row upward,
/// each row filled up to four bytes.
pub fn bmp(bits: u16, stream: &mut Stream) -> Image {
    const WIDTH: usize = SIDE - 3;
    let colours = if bits == 24 { 0 } else { 1_usize << bits };
    let mut draw = |below: usize| stream.below(below) as u8;
    let palette: Vec<[u8; 3]> = (0..colours).map(|_| [0; 3].map(|_| draw(256))).collect();
    let mut rows = Vec::new();
    let mut pixels = vec![([0; 3], None); SIDE * SIDE];
    for row in (0..SIDE).rev() {
        let mut packed = vec![0; (WIDTH * usize::from(bits)).div_ceil(32) * 4];
        for col in 0..WIDTH {
            let [red, green, blue] = match bits {
                24 => [0; 3].map(|_| draw(256)),
                _ => {
                    let number = draw(colours);
                    let per_byte = 8 / usize::from(bits);
                    let shift = 8 - usize::from(bits) * (col % per_byte + 1);
                    packed[col / per_byte] |= number << shift;
                    palette[usize::from(number)]
                }
            };
            if bits == 24 {
                packed[3 * col..3 * col + 3].copy_from_slice(&[blue, green, red]);
            }
            pixels[row * SIDE + col].0 = [red, green, blue].map(|level| u16::from(level) * 257);
        }
        rows.extend(packed);
    }
    let start = 54 + 4 * colours as u32;
    let mut bytes = b"BM".to_vec();
    for number in [
        start + rows.len() as u32,
        0,
        start,
        40,
        WIDTH as u32,
        SIDE as u32,
    ] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend([1, bits].map(u16::to_le_bytes).concat());
    for number in [0, 0, 0, 0, colours as u32, 0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(
        palette
            .iter()
            .flat_map(|[red, green, blue]| [*blue, *green, *red, 0]),
    );
    bytes.extend(rows);
    Image {
        what: format!("BMP, {bits} bits"),
        bytes,
        pixels: (0..SIDE)
            .flat_map(|row| pixels[row * SIDE..][..WIDTH].to_vec())
            .collect(),
    }
}

pub fn png(colour: ColorType, depth: BitDepth, stream: &mut Stream) -> Image {
    let (channels, bits) = (colour.samples(), depth as u8);
    let has_alpha = matches!(colour, ColorType::GrayscaleAlpha | ColorType::Rgba);
    let mut draw = |most: u32| stream.below(most as usize + 1) as u16;
    let most = (1_u32 << bits) - 1;
    // Colours by number, half of which have an opacity.
    let palette: Vec<u8> = (0..768).map(|_| draw(255) as u8).collect();
    let opacities: Vec<u8> = (0..128).map(|_| draw(255) as u8).collect();
    let (mut data, mut pixels) = (Vec::new(), Vec::new());
    for at in 0..SIDE * SIDE {
        let mut levels: Vec<u16> = (0..channels).map(|_| draw(most)).collect();
        // Every second pixel is opaque.
        if has_alpha && at % 2 == 0 {
            levels[channels - 1] = most as u16;
        }
        for level in &levels {
            match bits {
                16 => data.extend(level.to_be_bytes()),
                8 => data.push(*level as u8),
                _ if at % 8 == 0 => data.push((*level as u8) << 7),
                _ => *data.last_mut().unwrap() |= (*level as u8) << (7 - at % 8),
            }
        }
        let levels: Vec<u16> = levels.iter().map(|&level| wide(level, bits)).collect();
        pixels.push(match colour {
            ColorType::Indexed => {
                let number = usize::from(levels[0] / 257);
                let rgb = [0, 1, 2].map(|channel| palette[3 * number + channel]);
                let opacity = opacities.get(number).copied().unwrap_or(255);
                let wide = |level| wide(u16::from(level), 8);
                (rgb.map(wide), Some(wide(opacity)))
            }
            _ => {
                let colours = channels - usize::from(has_alpha);
                let rgb = [levels[0], levels[colours / 2], levels[colours - 1]];
                (rgb, has_alpha.then(|| levels[channels - 1]))
            }
        });
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIDE as u32, SIDE as u32);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if colour == ColorType::Indexed {
        encoder.set_palette(palette);
        encoder.set_trns(opacities);
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&data).unwrap();
    writer.finish().unwrap();
    Image {
        what: format!("PNG, {colour:?}, {depth:?}"),
        bytes,
        pixels,
    }
}

pub fn images(stream: &mut Stream) -> Vec<Image> {
    use ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb, Rgba};
    let mut images = vec![
        png(Grayscale, BitDepth::One, stream),
        png(Indexed, BitDepth::Eight, stream),
    ];
    for most in [1, 100, 255, 1000, 65535] {
        images.extend([2, 3, 5, 6].map(|kind| netpbm(kind, most, stream)));
    }
    images.extend([1, 4].map(|kind| netpbm(kind, 1, stream)));
    images.extend([1, 4, 8, 24].map(|bits| bmp(bits, stream)));
    for depth in [BitDepth::Eight, BitDepth::Sixteen] {
        let colours = [Grayscale, GrayscaleAlpha, Rgb, Rgba];
        images.extend(colours.map(|colour| png(colour, depth, stream)));
    }
    images
}
