//! Maps are read pixel by pixel as Nav2's map server of ROS 2 Humble reads them: compared with its
//! rules, written down here once more from the samples that the test drew, without any decoder.

use png::{BitDepth, ColorType};
use xcscr::world::{Occupancy, OccupancyMap};
use xcscr::xcs::random::Stream;

/// What an image holds of a pixel, as 16-bit channels: red, green, blue, and the opacity.
type Channels = ([u16; 3], Option<u16>);

/// A file of an image, and what it holds.
struct Image {
    what: String,
    bytes: Vec<u8>,
    pixels: Vec<Channels>,
}

const SIDE: usize = 16;

/// The value of a pixel: the mean of its channels is its shade; opacity counts as a channel in the
/// mode `trinary`, and hides a pixel in the mode `scale`; both thresholds are exclusive.
fn nav2(pixel: Channels, mode: &str, negate: bool, occupied: f64, free: f64) -> i8 {
    let (colours, alpha) = pixel;
    let mut channels: Vec<f64> = colours.map(f64::from).to_vec();
    if mode == "trinary" {
        channels.extend(alpha.map(f64::from));
    }
    let sum: f64 = channels.iter().sum();
    let shade = sum / channels.len() as f64 / 65535.0;
    let occ = if negate { shade } else { 1.0 - shade };
    let by_thresholds = || match () {
        () if occ > occupied => Some(100),
        () if occ < free => Some(0),
        () => None,
    };
    match mode {
        "trinary" => by_thresholds().unwrap_or(-1),
        "scale" if alpha.is_some_and(|alpha| alpha != 65535) => -1,
        "scale" => by_thresholds()
            .unwrap_or_else(|| ((occ - free) / (occupied - free) * 100.0).round_ties_even() as i8),
        _ => {
            let level = (shade * 255.0).round() as i64;
            if level <= 100 { level as i8 } else { -1 }
        }
    }
}

fn encoded(
    colour: ColorType,
    depth: BitDepth,
    palette: Option<(&[u8], &[u8])>,
    data: &[u8],
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIDE as u32, SIDE as u32);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if let Some((colours, opacities)) = palette {
        encoder.set_palette(colours.to_vec());
        encoder.set_trns(opacities.to_vec());
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
    writer.finish().unwrap();
    bytes
}

/// A byte as 16 bits.
fn wide(level: u8) -> u16 {
    u16::from(level) * 257
}

fn pgm(plain: bool, most: u16, stream: &mut Stream) -> Image {
    let levels: Vec<u16> = (0..SIDE * SIDE)
        .map(|_| stream.below(usize::from(most) + 1) as u16)
        .collect();
    let mut bytes = format!(
        "{}\n# drawn\n{SIDE} {SIDE}\n{most}\n",
        if plain { "P2" } else { "P5" }
    )
    .into_bytes();
    for &level in &levels {
        match (plain, most) {
            (true, _) => bytes.extend(format!("{level}\n").bytes()),
            (false, 0..=255) => bytes.push(level as u8),
            (false, _) => bytes.extend(level.to_be_bytes()),
        }
    }
    let full = |level: u16| (f64::from(level) * 65535.0 / f64::from(most)).round() as u16;
    Image {
        what: format!("PGM, plain {plain}, up to {most}"),
        bytes,
        pixels: levels
            .iter()
            .map(|&level| ([full(level); 3], None))
            .collect(),
    }
}

fn png(colour: ColorType, depth: BitDepth, stream: &mut Stream) -> Image {
    let (colours, has_alpha) = match colour {
        ColorType::Grayscale => (1, false),
        ColorType::GrayscaleAlpha => (1, true),
        ColorType::Rgb => (3, false),
        _ => (3, true),
    };
    let is_wide = depth == BitDepth::Sixteen;
    let (mut data, mut pixels) = (Vec::new(), Vec::new());
    for _ in 0..SIDE * SIDE {
        let mut sample = |is_opaque: bool| {
            let level = if is_opaque {
                65535
            } else {
                stream.below(65536) as u16
            };
            match is_wide {
                true => data.extend(level.to_be_bytes()),
                false => data.push((level >> 8) as u8),
            }
            if is_wide {
                level
            } else {
                wide((level >> 8) as u8)
            }
        };
        let levels: Vec<u16> = (0..colours).map(|_| sample(false)).collect();
        let is_opaque = pixels.len() % 2 == 0;
        let alpha = has_alpha.then(|| sample(is_opaque));
        let rgb = [levels[0], levels[colours / 2], levels[colours - 1]];
        pixels.push((rgb, alpha));
    }
    Image {
        what: format!("PNG, {colour:?}, {depth:?}"),
        bytes: encoded(colour, depth, None, &data),
        pixels,
    }
}

/// Black and white, a bit for each pixel.
fn bits(stream: &mut Stream) -> Image {
    let data: Vec<u8> = (0..SIDE * SIDE / 8)
        .map(|_| stream.below(256) as u8)
        .collect();
    let is_white = |at: usize| data[at / 8] >> (7 - at % 8) & 1 == 1;
    let pixels = (0..SIDE * SIDE).map(|at| ([if is_white(at) { 65535 } else { 0 }; 3], None));
    Image {
        what: "PNG, 1 bit".to_owned(),
        pixels: pixels.collect(),
        bytes: encoded(ColorType::Grayscale, BitDepth::One, None, &data),
    }
}

/// Colours by number, half of which are opaque.
fn palette(stream: &mut Stream) -> Image {
    let colours: Vec<u8> = (0..768).map(|_| stream.below(256) as u8).collect();
    let opacities: Vec<u8> = (0..128).map(|_| stream.below(256) as u8).collect();
    let data: Vec<u8> = (0..SIDE * SIDE).map(|_| stream.below(256) as u8).collect();
    let pixel = |&number: &u8| {
        let number = usize::from(number);
        let rgb = [0, 1, 2].map(|channel| wide(colours[3 * number + channel]));
        (
            rgb,
            Some(wide(opacities.get(number).copied().unwrap_or(255))),
        )
    };
    Image {
        what: "PNG, palette".to_owned(),
        pixels: data.iter().map(pixel).collect(),
        bytes: encoded(
            ColorType::Indexed,
            BitDepth::Eight,
            Some((&colours, &opacities)),
            &data,
        ),
    }
}

fn images(stream: &mut Stream) -> Vec<Image> {
    let mut images = vec![bits(stream), palette(stream)];
    for most in [1, 100, 255, 1000, 65535] {
        images.extend([true, false].map(|plain| pgm(plain, most, stream)));
    }
    for depth in [BitDepth::Eight, BitDepth::Sixteen] {
        for colour in [
            ColorType::Grayscale,
            ColorType::GrayscaleAlpha,
            ColorType::Rgb,
            ColorType::Rgba,
        ] {
            images.push(png(colour, depth, stream));
        }
    }
    images
}

#[test]
fn every_mode_and_format_is_read_by_the_rules_of_nav2() {
    let folder = tempfile::tempdir().unwrap();
    let (yaml, file) = (
        folder.path().join("map.yaml"),
        folder.path().join("map.img"),
    );
    let mut stream = Stream::new(7, 0_u64);
    let mut seen = [0_usize; 4];
    for (occupied, free) in [
        (0.65, 0.196),
        (0.65, 0.25),
        (0.6, 0.2),
        (0.8, 0.0),
        (1.0, 0.4),
    ] {
        for image in images(&mut stream) {
            std::fs::write(&file, &image.bytes).unwrap();
            for (mode, negate) in ["trinary", "scale", "raw"]
                .map(|mode| [(mode, 0), (mode, 1)])
                .concat()
            {
                let text = format!(
                    "image: map.img\nresolution: 0.05\norigin: [0, 0, 0]\nmode: {mode}\n\
                     negate: {negate}\noccupied_thresh: {occupied}\nfree_thresh: {free}\n"
                );
                std::fs::write(&yaml, text).unwrap();
                let map = OccupancyMap::load(&yaml).unwrap();
                for (at, &pixel) in image.pixels.iter().enumerate() {
                    let wanted = nav2(pixel, mode, negate == 1, occupied, free);
                    let found = map.value(at % SIDE, at / SIDE);
                    let what = &image.what;
                    assert_eq!(
                        found, wanted,
                        "{what}, {mode}, negate {negate}, {pixel:?}, {free}"
                    );
                    seen[match wanted {
                        -1 => 0,
                        0 => 1,
                        100 => 2,
                        _ => 3,
                    }] += 1;
                }
            }
        }
    }
    assert!(
        seen.iter().all(|&count| count > 10_000),
        "control: {seen:?}"
    );
}

/// A map of 8-bit grey levels in a row.
fn greys(levels: &[u8], lines: &str) -> OccupancyMap {
    let folder = tempfile::tempdir().unwrap();
    let mut pgm = format!("P5 {} 1 255\n", levels.len()).into_bytes();
    pgm.extend(levels);
    std::fs::write(folder.path().join("m.pgm"), pgm).unwrap();
    let yaml = folder.path().join("m.yaml");
    let text = format!("image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n{lines}\n");
    std::fs::write(&yaml, text).unwrap();
    OccupancyMap::load(&yaml).unwrap()
}

#[test]
fn a_grey_level_at_a_threshold_is_neither_free_nor_occupied_and_is_told() {
    // 51 and 153 are a fifth and three fifths of 255, to the last bit.
    let map = greys(
        &[50, 51, 52, 153, 154],
        "negate: 1\noccupied_thresh: 0.6\nfree_thresh: 0.2",
    );
    let values: Vec<i8> = (0..5).map(|col| map.value(col, 0)).collect();
    assert_eq!(values, [0, -1, -1, -1, 100]);
    assert_eq!(map.disputed, 2);
    assert_eq!(map.at(1, 0), Occupancy::Unknown);
}

#[test]
fn unknown_pixels_that_count_as_free_are_told_and_only_those() {
    let levels = [205, 205, 254, 0];
    let count = |lines: &str| greys(&levels, lines).unknown_as_free;
    assert_eq!(
        count("negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25"),
        2
    );
    assert_eq!(
        count("negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196"),
        0
    );
    assert_eq!(
        count("negate: 1\noccupied_thresh: 0.65\nfree_thresh: 0.25"),
        0
    );
    let read = greys(
        &levels,
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25",
    );
    assert_eq!(read.value(0, 0), 0, "Nav2 takes them for free");
}
