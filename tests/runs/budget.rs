//! No file but the picture of a map is larger for this program than its bytes say: bombs, files with holes, and what has no
//! end are refused, within ten times their size and 64 MiB.

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output};

use crate::kit::desk::Desk;
use crate::kit::program::ended;

/// What the program itself needs, threads and all, in KiB.
pub const ITSELF: u64 = 192 << 10;
/// What a small file may take besides, in KiB.
pub const SMALL: u64 = 64 << 10;

/// Runs a command line with so much address space, in KiB.
pub fn within(desk: &Desk, kib: u64, line: &str) -> Output {
    desk.limited(&format!("-v {kib}"), line).output().unwrap()
}

/// Runs a command line as [`within`] does for a small file. It must end with this code and these words.
#[track_caller]
pub fn small(desk: &Desk, code: i32, line: &str, words: &str) {
    let (stdout, stderr) = ended(&within(desk, ITSELF + SMALL, line), code, line);
    let said = stdout + &stderr;
    assert!(said.contains(words), "{line}: {said}");
}

/// Every command that reads a file.
const READERS: [&str; 9] = [
    "recording check FILE",
    "recording info FILE",
    "map FILE -o @out.svg",
    "evaluate FILE --world worlds/maze4.json",
    "world info FILE",
    "train FILE --out @out",
    "train maze4 --config FILE --out @out",
    "train maze4 --init-rules FILE --out @out",
    "study run FILE --out @out",
];
/// Commands that read files of a folder `run`.
const READERS_OF_A_RUN: [&str; 2] = ["train --resume @run", "study status @run"];

/// The command lines that read this file.
fn readers(file: &str) -> impl Iterator<Item = String> {
    READERS
        .into_iter()
        .map(move |line| line.replace("FILE", file))
}

#[test]
fn three_gigabytes_of_nothing_take_no_memory() {
    let desk = Desk::new();
    let hole = desk.path("hole.mcap");
    File::create(&hole).unwrap().set_len(3 << 30).unwrap();
    desk.write("run/world.json", fs::read("worlds/maze4.json").unwrap());
    for name in ["config.json", "rules.json", "unfinished.json", "study.json"] {
        fs::hard_link(&hole, desk.path("run").join(name)).unwrap();
    }
    let of_a_run = READERS_OF_A_RUN.iter().map(|&line| line.to_owned());
    for line in readers("@hole.mcap").chain(of_a_run) {
        let output = within(&desk, ITSELF + SMALL, &line);
        let code = output.status.code().unwrap_or(-1);
        assert!([65, 74].contains(&code), "{line}: {output:?}");
        let (_, stderr) = ended(&output, code, &line);
        assert!(stderr.contains("larger than"), "{line}: {stderr}");
    }
}

#[test]
fn pipes_and_devices_are_refused_at_once() {
    let desk = Desk::new();
    let made = Command::new("mkfifo").arg(desk.path("pipe")).status();
    assert!(made.unwrap().success());
    fs::create_dir(desk.path("run")).unwrap();
    for file in ["unfinished.json", "study.json"] {
        symlink("/dev/zero", desk.path("run").join(file)).unwrap();
    }
    let of_a_run = READERS_OF_A_RUN.iter().map(|&line| line.to_owned());
    let lines = readers("@pipe").chain(readers("/dev/zero")).chain(of_a_run);
    for line in lines {
        // Nobody writes into the pipe: who opens it waits for ever.
        let mut command = Command::new("timeout");
        command.args(["20", env!("CARGO_BIN_EXE_xcscr")]);
        command.args(desk.args(&line));
        command.current_dir(env!("CARGO_MANIFEST_DIR"));
        let (_, stderr) = ended(&command.output().unwrap(), 74, &line);
        assert!(stderr.contains("not a regular file"), "{line}: {stderr}");
    }
}

#[test]
fn ten_megabytes_of_anything_need_at_most_ten_times_their_size_and_64_mib() {
    let desk = Desk::new();
    for (name, piece) in [
        ("brackets", "["),
        ("objects", r#"{"rules":"#),
        ("tables", "a={"),
        ("keys", "a.b.c=1\n"),
        ("numbers", "1e308,"),
        ("rows", r#"{"rows":["","","","#),
        ("nul", "\0"),
        ("the beginning of recordings", "\u{89}MCAP0\r\n"),
    ] {
        let size = 10 << 20;
        desk.write("large", piece.repeat(size / piece.len()));
        for line in readers("@large") {
            let output = within(&desk, ((10 * size as u64) >> 10) + SMALL, &line);
            let (_, stderr) = ended(&output, 65, &format!("{name}: {line}"));
            assert!(stderr.len() < 10_000, "{name}: {line}: a long message");
        }
    }
}

/// Pixels of one grey, packed a thousand times smaller.
fn picture(path: &Path, side: u32) -> u64 {
    let mut encoder = png::Encoder::new(File::create(path).unwrap(), side, side);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::High);
    let pixels = vec![254; side as usize * side as usize];
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    fs::metadata(path).unwrap().len()
}

#[test]
fn a_picture_is_read_up_to_64_million_pixels_within_14_bytes_for_each() {
    let desk = Desk::new();
    let header = "image: m.png\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n\
                  occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    desk.write("m.yaml", header);
    let line = "world convert @m.yaml -o @w.json --cell 4 --goal 20,20";
    let size = picture(&desk.path("m.png"), 8192);
    assert!(size < 100_000, "{size} bytes");
    small(&desk, 65, line, "8192 x 8192 pixels are more than 64000000");
    // A map of 200 m at 5 cm, packed a thousand times smaller.
    picture(&desk.path("m.png"), 4096);
    let room = (14 << 24) >> 10;
    ended(&within(&desk, ITSELF + room, line), 0, line);
}

/// Nothing tells the cells apart, edges are joined, and episodes start in all: what can be believed
/// there is more than can be weighed.
#[test]
fn bounds_of_a_world_without_landmarks_are_unknown_and_take_no_memory() {
    let desk = Desk::new();
    for side in [10, 100] {
        let mut rows = vec![".".repeat(side); side];
        rows[side / 2].replace_range(..1, "G");
        desk.write("w.json", format!(r#"{{"wrap": true, "rows": {rows:?}}}"#));
        small(
            &desk,
            0,
            "world info @w.json --bounds",
            "unknown start  unknown",
        );
    }
    let train = "train @w.json --arena grid --episodes 1 --out @out";
    small(
        &desk,
        0,
        &format!("{train} --set reward.step_threshold=50"),
        "",
    );
}

/// What a world of 1024 x 1024 cells and all that is made of it may take. The largest has sixteen times
/// as many cells, and would take this test minutes without optimisation.
const LARGEST: u64 = 100 << 10;

#[test]
fn a_world_of_a_million_cells_is_trained_in_within_100_megabytes_and_too_large_a_one_is_refused() {
    let desk = Desk::new();
    let side = 1024;
    let mut rows = vec![format!("#{}#", ".".repeat(side - 2)); side];
    rows[0] = "#".repeat(side);
    rows[side - 1] = rows[0].clone();
    rows[1].replace_range(1..2, "S");
    rows[side - 2].replace_range(side - 2..side - 1, "G");
    desk.write("w.json", format!(r#"{{"rows": {rows:?}}}"#));
    desk.write(
        "tall.json",
        format!(r#"{{"rows": {:?}}}"#, vec!["###"; 4097]),
    );
    let train = "train @w.json --arena grid --episodes 1 --quiet --force --out @out";
    let few = format!("{train} --set reward.step_threshold=100");
    for (code, line, words) in [
        (0, &few[..], "the longest shortest path has 2042"),
        // With as many steps as the maze asks for.
        (0, train, ""),
        (
            65,
            "replay @out --html @page.html",
            "too many cells for the page of a run",
        ),
        (
            65,
            "world info @tall.json",
            "at most 4096 columns and 4096 rows",
        ),
    ] {
        let (_, stderr) = ended(&within(&desk, ITSELF + LARGEST, line), code, line);
        assert!(stderr.contains(words), "{line}: {stderr}");
    }
}

#[test]
fn memory_that_cannot_be_had_ends_in_code_74_or_aborts_with_a_message() {
    let desk = Desk::new();
    let text = "name = \"s\"\nworlds = [\"rooms-100-1\"]\nmethods = [\"dyna-q\"]\n\
                sensors = [\"position\"]\ntrials = 4\nepisodes = 2\n";
    desk.write("s.toml", text);
    let (mut refused, mut enough) = (0, 0);
    // With too little, the program itself cannot be loaded, and the system ends it.
    let is_loaded = |mib: &u64| within(&desk, mib << 10, "--version").status.success();
    for mib in (32..160).step_by(16).filter(is_loaded) {
        let line = "study run @s.toml --out @out --jobs 4 --quiet";
        let output = within(&desk, mib << 10, line);
        let code = output.status.code();
        // The standard library aborts when an allocation fails.
        let aborted = output.status.signal() == Some(6)
            && String::from_utf8_lossy(&output.stderr).contains("memory allocation of");
        assert!(
            matches!(code, Some(0 | 74)) || aborted,
            "{mib} MiB: {output:?}"
        );
        refused += usize::from(code != Some(0));
        enough += usize::from(code == Some(0));
        let _ = fs::remove_dir_all(desk.path("out"));
        // What is more than enough shows nothing new.
        if enough == 2 {
            break;
        }
    }
    assert!(refused > 0, "no limit was too little");
    assert!(enough > 0, "control: no limit was enough");
}
