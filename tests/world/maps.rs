//! ROS 2 maps become worlds, and worlds maps, as Nav2's map server reads them.

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use tempfile::TempDir;
use xcscr::world::{Gridded, Gridding, MapError, Maze, OccupancyMap};
use xcscr::xcs::random::Stream;

use crate::kit::folder::replace;
use crate::kit::program::{ended, xcscr};

/// Grey levels of Nav2's saver: free, occupied, unknown.
const GREY: [(char, u8); 3] = [(' ', 254), ('#', 0), ('?', 205)];

/// A folder with a map.
pub struct Map(pub TempDir);

impl Map {
    /// A map drawn with a letter for each pixel, 0.1 m wide.
    pub fn drawn(rows: &[&str]) -> Self {
        let levels = rows.iter().flat_map(|row| row.chars());
        let grey = |letter| GREY.iter().find(|(known, _)| *known == letter).unwrap().1;
        let mut pgm = format!("P5\n# drawn\n{} {}\n255\n", rows[0].len(), rows.len()).into_bytes();
        pgm.extend(levels.map(grey));
        let map = Self(tempfile::tempdir().unwrap());
        map.keep("map.pgm", &pgm);
        map.yaml("");
        map
    }

    /// The map of a world.
    fn of(maze: &Maze) -> Self {
        let map = Self(tempfile::tempdir().unwrap());
        let files = maze.to_map("map.pgm");
        map.keep("map.yaml", files.yaml.as_bytes());
        map.keep("map.pgm", &files.image);
        map
    }

    /// The world that the map holds.
    fn world(&self) -> Maze {
        plain().of(&self.load().unwrap()).unwrap().maze
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn keep(&self, name: &str, bytes: &[u8]) {
        replace(&self.path(name), bytes);
    }

    /// The usual header; the lines given come last, and win over those with the same key.
    pub fn yaml(&self, lines: &str) {
        let usual = [
            "image: map.pgm",
            "resolution: 0.1",
            "origin: [0.0, 0.0, 0.0]",
            "negate: 0",
            "occupied_thresh: 0.65",
            "free_thresh: 0.196",
        ];
        let given = |line: &&str| !lines.contains(line.split(':').next().unwrap());
        let kept: Vec<&str> = usual.into_iter().filter(given).collect();
        self.keep(
            "map.yaml",
            format!("{}\n{lines}\n", kept.join("\n")).as_bytes(),
        );
    }

    pub fn load(&self) -> Result<OccupancyMap, MapError> {
        OccupancyMap::load(&self.path("map.yaml"))
    }

    pub fn gridded(
        &self,
        cell_m: f64,
        start: Option<[f64; 2]>,
        goal: [f64; 2],
    ) -> Result<Gridded, MapError> {
        let gridding = Gridding {
            cell_m: Some(cell_m),
            start_m: start,
            goal_m: Some(goal),
            ..plain()
        };
        gridding.of(&self.load().unwrap())
    }
}

pub fn plain() -> Gridding {
    Gridding {
        cell_m: None,
        start_m: None,
        goal_m: None,
        unknown_is_free: false,
        yaw_rad: 0.0,
        despeckle: 0,
        offset_m: None,
        name: "converted".to_owned(),
    }
}

pub fn rows(maze: &Maze) -> Vec<String> {
    let json: serde_json::Value = serde_json::from_str(&maze.to_json()).unwrap();
    let rows = json["rows"].as_array().unwrap().iter();
    rows.map(|row| row.as_str().unwrap().to_owned()).collect()
}

/// A world of a hundred thousand free cells.
fn large() -> Maze {
    const SIDE: usize = 330;
    let mut rows = vec![format!("#{}#", ".".repeat(SIDE - 2)); SIDE];
    (rows[0], rows[SIDE - 1]) = ("#".repeat(SIDE), "#".repeat(SIDE));
    rows[1].replace_range(1..3, "SG");
    crate::world::worlds::drawn(serde_json::json!({}), &rows)
}

#[test]
fn every_world_that_ships_and_a_large_one_come_back_from_their_maps_as_they_were() {
    let mut worlds = crate::world::worlds::files("worlds");
    worlds.extend(crate::world::worlds::files("worlds/classic"));
    assert!(worlds.len() > 30, "{worlds:?}");
    let shipped = worlds.iter().map(|world| Maze::load(world).unwrap());
    for maze in shipped.chain([large()]) {
        assert_eq!(Map::of(&maze).world(), maze, "{}", maze.name());
    }
}

#[test]
fn a_placed_world_goes_to_a_map_and_back_without_a_change() {
    let world = serde_json::json!({
        "name": "hall", "cell_size_m": 0.35, "moves": 8, "origin": [-10.1, 0.30000000000000004, -0.7],
        "rows": ["########", "#S...G.#", "#.G....#", "########"],
        "floor": ["########", "#2.9..1#", "#.3.5..#", "########"]
    });
    let maze = Maze::from_json(world.to_string().as_bytes(), "hall.json").unwrap();
    let map = Map::of(&maze);
    assert_eq!(map.world(), maze);
    assert_eq!(map.world().to_json(), maze.to_json());
    // For Nav2 all free cells are free, whatever is in them.
    let free = maze.free_cells().count();
    assert_eq!(map.load().unwrap().counts(), [free, 32 - free, 0]);
    // A pixel that was painted black is a wall, and all else stays.
    let mut painted = fs::read(map.path("map.pgm")).unwrap();
    let pixel = painted.len() - 32 + 8 + 2;
    painted[pixel] = 0;
    map.keep("map.pgm", &painted);
    let changed = map.world();
    assert_eq!(rows(&changed)[1], "#S#..G.#");
    assert_eq!(changed.floor_rows().unwrap()[1], "#2#9..1#");
    // A wall that was painted white is free.
    let map = Map::of(&changed);
    painted[pixel] = 254;
    map.keep("map.pgm", &painted);
    assert_eq!(rows(&map.world())[1], "#S...G.#");
    let resized = [&b"P5\n8 2\n255\n"[..], &[0; 16]].concat();
    map.keep("map.pgm", &resized);
    let error = plain().of(&map.load().unwrap()).unwrap_err().to_string();
    assert!(error.contains("8 x 2 pixels"), "{error}");
}

#[test]
fn what_is_wrong_in_a_header_or_an_image_is_named() {
    let map = Map::drawn(&["   ", "   "]);
    for (lines, told) in [
        ("resolution: 0", "`resolution` is 0"),
        ("resolution: .nan", "`resolution` is NaN"),
        ("origin: [1, 2]", "`origin` must be three numbers"),
        ("free_thresh: 0.7", "must be less than `occupied_thresh`"),
        (
            "occupied_thresh: 1.5",
            "`occupied_thresh` is 1.5, but must be from 0 to 1",
        ),
        ("mode: binary", "binary"),
        ("image: no.pgm", "no.pgm"),
        ("image: [", "does not describe a map"),
    ] {
        map.yaml(lines);
        let text = map.load().unwrap_err().to_string();
        assert!(text.contains(told), "{lines}: {text}");
    }
    map.yaml("");
    for (image, told) in [
        (&b"P7 1 1 255\n..."[..], "neither PGM"),
        (b"P5 99999999999 99999999 255\n", "is longer than 65536"),
        (b"P5 9999 9999 255\n", "are more than"),
        (b"P5 8000 8000 255\n", "ends after 0 of the 64000000 bytes"),
        (b"P2 8000 8000 255\n1 2 3", "expected a number at byte"),
        (b"P2 1 1 255\n256", "exceeds the maximum"),
        (b"P5 0 3 255\n", "no pixel"),
        (b"\x89PNG\r\n", "image"),
    ] {
        map.keep("map.pgm", image);
        let text = map.load().unwrap_err().to_string();
        assert!(text.contains(told), "{told}: {text}");
    }
}

/// What headers of maps and images like to hold in a wrong place.
const PIECES: &str = "0,-1,255,65536,99999999999,1e999,.nan,[,: ,&a,*a,\n";

fn damaged(whole: &[u8], stream: &mut Stream) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let pieces: Vec<&str> = PIECES.split(',').collect();
    for _ in 0..=stream.below(3) {
        let at = stream.below(bytes.len() + 1);
        let to = (at + stream.below(6)).min(bytes.len());
        let piece = pieces[stream.below(pieces.len())].bytes();
        match stream.below(4) {
            0 => drop(bytes.drain(at..to)),
            1 => drop(bytes.splice(at..to, piece)),
            _ if at < bytes.len() => bytes[at] = stream.below(256) as u8,
            _ => bytes.extend(piece),
        }
    }
    bytes
}

/// A PNG whose chunks are damaged, lost or doubled, and have right checksums.
fn forged_png(whole: &[u8], stream: &mut Stream) -> Vec<u8> {
    let (magic, mut rest) = whole.split_at(8);
    let mut chunks: Vec<Vec<u8>> = Vec::new();
    while rest.len() >= 12 {
        let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
        chunks.push(rest[4..8 + length].to_vec());
        rest = &rest[12 + length..];
    }
    let at = stream.below(chunks.len());
    match stream.below(8) {
        0 => drop(chunks.remove(at)),
        1 => chunks.insert(at, chunks[at].clone()),
        _ => {
            let chunk = &mut chunks[at];
            let place = if chunk.len() > 4 { 4 } else { 0 };
            let place = place + stream.below(chunk.len() - place);
            chunk[place] = [0, 1, 3, 6, 16, 255][stream.below(6)];
        }
    }
    let mut bytes = magic.to_vec();
    for chunk in chunks {
        bytes.extend((chunk.len() as u32 - 4).to_be_bytes());
        bytes.extend(&chunk);
        bytes.extend(crc32fast::hash(&chunk).to_be_bytes());
    }
    bytes
}

/// The picture of a map as PNG.
fn png_of(greys: &[u8], width: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let height = greys.len() as u32 / width;
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(greys).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn damaged_maps_are_read_or_refused_and_never_panic() {
    let map = Map::drawn(&["####", "#  #", "####"]);
    let read = |name: &str| fs::read(map.path(name)).unwrap();
    let (header, raw) = (read("map.yaml"), read("map.pgm"));
    let greys = &raw[raw.len() - 12..];
    let words: Vec<String> = greys.iter().map(u8::to_string).collect();
    let plain_pgm = format!("P2\n4 3\n255\n{}\n", words.join(" ")).into_bytes();
    let png = png_of(greys, 4);
    let mut stream = Stream::new(5, 0_u64);
    for (kind, name, whole) in [
        ("header", "map.yaml", &header),
        ("raw", "map.pgm", &raw),
        ("plain", "map.pgm", &plain_pgm),
        ("png", "map.pgm", &png),
    ] {
        let mut refused = 0;
        let times = crate::kit::chance::rounds([100, 1_000, 100_000]);
        for _ in 0..times {
            let forged = match kind {
                "png" => forged_png(whole, &mut stream),
                _ => damaged(whole, &mut stream),
            };
            map.keep(name, &forged);
            let gridding = Gridding {
                goal_m: Some([0.15, 0.15]),
                ..plain()
            };
            let made = map.load().and_then(|map| gridding.of(&map).map(|_| ()));
            refused += usize::from(made.is_err());
        }
        map.keep("map.yaml", &header);
        map.keep("map.pgm", &raw);
        assert!(
            (times / 10..times).contains(&refused),
            "{kind}: {refused} refused"
        );
    }
}

#[test]
fn convert_reads_a_map_from_anywhere_draws_it_and_overwrites_nothing() {
    let map = Map::drawn(&["??????", "?    ?", "?    ?", "?    ?", "??????"]);
    let ends = |words: &str, code: i32| {
        let mut command = xcscr(&["world"]);
        let command = command.current_dir(map.path("")).args(words.split(' '));
        ended(&command.output().unwrap(), code, words)
    };
    let convert = "convert map.yaml -o w.json --cell 0.1 --goal";
    let drawn = format!("{convert} 0.45,0.15 --preview p.svg");
    let (stdout, _) = ends(&drawn, 0);
    let counts = "12 free, 0 occupied, 18 unknown (taken as wall)";
    assert!(stdout.contains(counts), "{stdout}");
    ends("check w.json", 0);
    let picture = fs::read_to_string(map.path("p.svg")).unwrap();
    let (_, image) = picture.split_once("base64,").unwrap();
    let (image, grid) = image.split_once('"').unwrap();
    let image = STANDARD.decode(image).unwrap();
    let mut image = png::Decoder::new(Cursor::new(image)).read_info().unwrap();
    let mut greys = vec![0; image.output_buffer_size().unwrap()];
    image.next_frame(&mut greys).unwrap();
    // The map is 6 x 5 pixels, and 12 of them are free.
    let free = greys.iter().filter(|&&grey| grey == 254).count();
    assert_eq!((greys.len(), free), (30, 12), "the map is drawn");
    let frames = grid.matches("zM").count() + grid.matches("z\"").count();
    assert!(grid.contains("<circle") && frames == 1 + 12, "{grid}");
    ends(&drawn, 73);
    let (stdout, _) = ends(&format!("{convert} 0.45,0.15 --unknown free --force"), 0);
    let is_free = stdout.contains("8 x 7 cells") && stdout.contains("30 free");
    assert!(is_free, "{stdout}");
    let (_, stderr) = ends(&format!("{convert} 0.05,0.05 --force"), 2);
    let nearest = "the nearest free cell is at 0.15,0.15";
    assert!(stderr.contains(nearest), "a goal in a wall: {stderr}");
    ends("convert w.json -o back.yaml", 0);
    assert!(map.path("back.pgm").is_file());
    // A name that YAML would read as a comment.
    ends("convert w.json -o #back.yaml", 0);
    ends("convert #back.yaml -o again.json", 0);
    let (_, stderr) = ends("convert w.json -o back.yaml --force --cell 0.5", 2);
    assert!(stderr.contains("--cell is for maps"), "{stderr}");
}

#[test]
fn a_map_in_the_place_of_a_world_and_a_pixel_in_the_place_of_a_cell_are_refused_with_the_remedy() {
    let map = Map::drawn(&["    ", "    "]);
    let refused = |arguments: &str, code: i32| {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let mut command = xcscr(&arguments);
        let output = command.current_dir(map.path("")).output().unwrap();
        ended(&output, code, &arguments.join(" ")).1
    };
    let stderr = refused("world check map.yaml", 65);
    assert!(stderr.contains("xcscr world convert map.yaml"), "{stderr}");
    map.yaml("resolution: 0.05");
    let stderr = refused("world convert map.yaml -o w.json --goal 0.1,0.1", 2);
    assert!(stderr.contains("such as `--cell 0.5`"), "{stderr}");
}
