//! Maps are read pixel by pixel as Nav2's map server of ROS 2 Humble reads them: compared with its
//! rules, written down here once more from the samples that the test drew, without any decoder.

use xcscr::world::{Occupancy, OccupancyMap};
use xcscr::xcs::random::Stream;

use super::nav2_images::{Channels, bmp, images};
use crate::world::maps::Map;

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

#[test]
fn every_mode_and_format_is_read_by_the_rules_of_nav2() {
    let map = Map(tempfile::tempdir().unwrap());
    let mut stream = Stream::new(7, 0_u64);
    let mut seen = [0_usize; 4];
    let modes = ["trinary", "scale", "raw"];
    for (occupied, free) in [
        (0.65, 0.196),
        (0.65, 0.25),
        (0.6, 0.2),
        (0.8, 0.0),
        (1.0, 0.4),
    ] {
        for image in images(&mut stream) {
            map.keep("map.pgm", &image.bytes);
            for (mode, negate) in modes.map(|mode| [(mode, 0), (mode, 1)]).concat() {
                let thresholds = format!("occupied_thresh: {occupied}\nfree_thresh: {free}");
                map.yaml(&format!("mode: {mode}\nnegate: {negate}\n{thresholds}"));
                let read = map.load().unwrap();
                for (at, &pixel) in image.pixels.iter().enumerate() {
                    let wanted = nav2(pixel, mode, negate == 1, occupied, free);
                    let found = read.value(at % read.width, at / read.width);
                    let what = &image.what;
                    assert_eq!(
                        found, wanted,
                        "{what}, {mode}, negate {negate}, {pixel:?}, {free}"
                    );
                    let kind = [-1, 0, 100].iter().position(|&known| known == wanted);
                    seen[kind.unwrap_or(3)] += 1;
                }
            }
        }
    }
    let is_many = seen.iter().all(|&count| count > 10_000);
    assert!(is_many, "control: {seen:?}");
}

/// A map of a white, a grey and a black pixel with these lines in its header.
fn with_header(lines: &str) -> Result<OccupancyMap, String> {
    let map = Map(tempfile::tempdir().unwrap());
    map.keep("map.pgm", b"P5 3 1 255\n\xff\x80\x00");
    map.yaml(lines);
    map.load().map_err(|fault| fault.to_string())
}

#[test]
fn scalars_of_the_header_are_read_as_nav2_reads_them() {
    let plain = [0, -1, 100];
    let negated = [100, -1, 0];
    // 50 % is between the thresholds: (0.498 - 0.196) / (0.65 - 0.196) is 67 %.
    let scaled = [0, 67, 100];
    for (lines, wanted) in [
        ("negate: 0", plain),
        ("negate: 1", negated),
        ("negate: 7", negated),
        ("negate: -1", negated),
        ("negate: '0'", plain),
        ("negate: \"1\"", negated),
        ("negate: false", plain),
        ("negate: True", negated),
        ("negate: no", plain),
        ("negate: YES", negated),
        ("negate: off", plain),
        ("negate: On", negated),
        ("negate: n", plain),
        ("mode: trinary", plain),
        ("mode: Trinary", plain),
        ("mode: SCALE", scaled),
        ("mode: 'scale'", scaled),
        ("mode: Raw\nnegate: 1", [-1, -1, 0]),
        ("resolution: '0.05'", plain),
        ("resolution: 5e-2", plain),
        ("resolution: 1", plain),
        ("origin: ['1', -2.5, 0]", plain),
        ("origin:\n- 1\n- 2\n- 3.0", plain),
        ("free_thresh: \"0.25\"\noccupied_thresh: '0.65'", plain),
        ("free_thresh: 0\noccupied_thresh: 1", [-1, -1, -1]),
        ("unknown: {a: [1, 2]}", plain),
    ] {
        let map = with_header(lines).unwrap_or_else(|fault| panic!("{lines}: {fault}"));
        assert_eq!([0, 1, 2].map(|col| map.value(col, 0)), wanted, "{lines}");
    }
}

#[test]
fn what_nav2_refuses_or_would_pass_on_as_nonsense_is_refused_with_the_remedy() {
    for (lines, words) in [
        ("negate: 1.0", "`negate` is \"1.0\", but must be 0 or 1"),
        ("negate: maybe", "`negate` is \"maybe\", but must be 0 or 1"),
        ("negate:", "`negate` has no value"),
        ("# no resolution: here", "`resolution` has no value"),
        (
            "mode: binary",
            "`mode` is \"binary\", but must be trinary, scale or raw",
        ),
        ("image: ''", "`image` is empty"),
        (
            "resolution: wide",
            "`resolution` is \"wide\", but must be a number",
        ),
        (
            "resolution: infinity",
            "`resolution` is \"infinity\", but must be a number",
        ),
        ("resolution: .inf", "from 0.001 to 10 metres"),
        ("resolution: -0.05", "from 0.001 to 10 metres"),
        ("origin: 1", "origin"),
        ("origin: [1, 2, 3, 4]", "`origin` must be three numbers"),
        (
            "origin: [0, 0, .nan]",
            "the third value of `origin` is NaN; set it to 0",
        ),
        (
            "origin: [0, .inf, 0]",
            "the second value of `origin` is inf; set it to 0",
        ),
        (
            "origin: [-.inf, 0, 0]",
            "the first value of `origin` is -inf; set it to 0",
        ),
        (
            "origin: [x, 0, 0]",
            "`origin` is \"x\", but must be a number",
        ),
        ("origin: [1e9, 0, 0]", "x and y must be from"),
        (
            "free_thresh: .nan",
            "`free_thresh` is NaN, but must be from 0 to 1",
        ),
        (
            "occupied_thresh: 65",
            "`occupied_thresh` is 65, but must be from 0 to 1",
        ),
        (
            "occupied_thresh: 0.1",
            "must be less than `occupied_thresh`",
        ),
    ] {
        let fault = with_header(lines).expect_err(lines);
        assert!(fault.contains(words), "{lines}: {fault}");
    }
    let map = Map(tempfile::tempdir().unwrap());
    map.yaml("");
    for (bytes, words) in [
        (&b"GIF89a"[..], "convert it"),
        (b"", "convert it"),
        (b"P7 1 1 1", "convert it"),
        (b"BM", "its header is too short"),
        (b"\xff\xd8\xff", "not a readable image"),
        (b"P6 1 1 255 ab", "it ends after 2 of the 3 bytes"),
        (b"P4 9 2 abc", "it ends after 3 of the 4 bytes"),
        (b"P3 1 1 7 1 2 8", "the level 8 exceeds the maximum, 7"),
        (b"P1 2 1 02", "expected 0 or 1 at byte 8"),
        (b"P5 65537 1 255 ", "a side of 65537 pixels is longer"),
        (b"P5 60000 60000 255 ", "are more than 64000000"),
    ] {
        map.keep("map.pgm", bytes);
        let fault = map.load().unwrap_err().to_string();
        assert!(fault.contains(words), "{bytes:?}: {fault}");
    }
}

#[test]
fn a_jpeg_is_read_in_grey_and_in_colours() {
    let map = Map(tempfile::tempdir().unwrap());
    // Blocks of one colour: white, grey 205 and black; and white, red and black.
    for (bytes, free_thresh, wanted) in [
        (&include_bytes!("greys.jpg")[..], 0.25, [0, 0, 100]),
        (include_bytes!("greys.jpg"), 0.19, [0, -1, 100]),
        (include_bytes!("colours.jpg"), 0.19, [0, 100, 100]),
        (include_bytes!("progressive.jpg"), 0.19, [0, -1, 100]),
    ] {
        map.keep("map.pgm", bytes);
        map.yaml(&format!("free_thresh: {free_thresh}"));
        let read = map.load().unwrap();
        assert_eq!((read.width, read.height), (24, 8));
        assert_eq!([0, 1, 2].map(|block| read.value(8 * block + 4, 4)), wanted);
        map.keep("map.pgm", &bytes[..bytes.len() - 40]);
        assert!(map.load().is_err(), "truncated");
    }
}

#[test]
fn a_damaged_image_is_read_or_refused_without_a_panic() {
    let map = Map(tempfile::tempdir().unwrap());
    map.yaml("");
    let mut stream = Stream::new(9, 0_u64);
    let mut seeds: Vec<Vec<u8>> = [1, 4, 8, 24]
        .map(|bits| bmp(bits, &mut stream).bytes)
        .into();
    seeds.push(include_bytes!("colours.jpg").to_vec());
    seeds.push(include_bytes!("progressive.jpg").to_vec());
    let mut refused = 0;
    for round in 0..1200 {
        let mut bytes = seeds[round % seeds.len()].clone();
        for _ in 0..1 + stream.below(4) {
            // Most faults are in the header.
            let reach = if stream.below(3) > 0 { 80 } else { bytes.len() };
            let at = stream.below(reach.min(bytes.len()));
            bytes[at] = stream.below(256) as u8;
        }
        if stream.below(4) == 0 {
            bytes.truncate(stream.below(bytes.len()));
        }
        map.keep("map.pgm", &bytes);
        refused += usize::from(map.load().is_err());
    }
    assert!((100..1100).contains(&refused), "control: {refused}");
}

/// A map of 8-bit grey levels in a row.
fn greys(levels: &[u8], negate: u8, occupied: f64, free: f64) -> OccupancyMap {
    let map = Map(tempfile::tempdir().unwrap());
    let head = format!("P5 {} 1 255\n", levels.len()).into_bytes();
    map.keep("map.pgm", &[&head, levels].concat());
    map.yaml(&format!(
        "negate: {negate}\noccupied_thresh: {occupied}\nfree_thresh: {free}"
    ));
    map.load().unwrap()
}

#[test]
fn a_grey_level_at_a_threshold_is_neither_free_nor_occupied_and_is_told() {
    // 51 and 153 are a fifth and three fifths of 255, to the last bit.
    let map = greys(&[50, 51, 52, 153, 154], 1, 0.6, 0.2);
    let values: Vec<i8> = (0..5).map(|col| map.value(col, 0)).collect();
    assert_eq!(values, [0, -1, -1, -1, 100]);
    assert_eq!(map.disputed, 2);
    assert_eq!(map.at(1, 0), Occupancy::Unknown);
}

#[test]
fn unknown_pixels_that_count_as_free_are_told_and_only_those() {
    for (negate, free, expected) in [(0, 0.25, 2), (0, 0.196, 0), (1, 0.25, 0)] {
        let read = greys(&[205, 205, 254, 0], negate, 0.65, free);
        assert_eq!(read.unknown_as_free, expected, "{negate} {free}");
        if expected > 0 {
            assert_eq!(read.value(0, 0), 0, "Nav2 takes them for free");
        }
    }
}

#[test]
fn a_map_in_which_no_cell_is_free_is_refused_with_the_numbers_of_its_pixels() {
    let map = Map::drawn(&["###", "# #", "#?#"]);
    let fault = map.gridded(0.3, None, [0.15, 0.15]).unwrap_err();
    let words = "no cell is free: 7 of the 9 pixels are occupied and 1 unknown; check `negate`";
    assert!(fault.to_string().contains(words), "{fault}");
}
