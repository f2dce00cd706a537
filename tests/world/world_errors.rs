//! Every kind of bad world file is refused with a message that points at the place.
//!
//! The tables hold a name and a file for each fault; the snapshots hold the messages, one under
//! each name.

use std::fs;

use crate::kit::program::{ended, xcscr};
use xcscr::world::{Maze, WorldError};

/// A fault and a file that has it.
type Case = (&'static str, Vec<u8>);

/// A world of these rows, each on its own line.
fn rows(rows: &str) -> Vec<u8> {
    let rows: Vec<String> = rows
        .split(' ')
        .map(|row| format!("    \"{row}\""))
        .collect();
    format!("{{\n  \"rows\": [\n{}\n  ]\n}}\n", rows.join(",\n")).into_bytes()
}

/// A small world without fault, but for a line before its rows.
fn with(line: &str) -> Vec<u8> {
    let sound = String::from_utf8(rows("#### #SG# ####")).unwrap();
    sound.replacen("{\n", &format!("{{\n  {line},\n"), 1).into()
}

/// The cases of a table, one a line: a fault, and a whole file, a line of one, or its rows. `\n` breaks lines.
fn cases(table: &'static str) -> Vec<Case> {
    let case = |line: &'static str| {
        let (fault, text) = line.split_once(": ").unwrap();
        let text = text.replace(r"\n", "\n");
        let file = match text.as_bytes()[0] {
            b'{' => format!("{text}\n").into_bytes(),
            b'"' => with(&text),
            _ => rows(&text),
        };
        (fault, file)
    };
    table.trim().lines().map(case).collect()
}

/// What the library says about a file; panics unless it refuses it, and says where.
#[track_caller]
fn refusal(fault: &str, text: &[u8]) -> String {
    match Maze::from_json(text, "bad.json") {
        Err(WorldError::Invalid(found)) => {
            assert!(found.starts_with("bad.json:"), "{fault}: {found}");
            found
        }
        other => panic!("{fault}: {other:?}"),
    }
}

/// All messages of a table, each under the name of its fault.
fn refusals(cases: &[Case]) -> String {
    let said = cases.iter().map(|(fault, text)| {
        let message = refusal(fault, text);
        format!("# {fault}\n{message}\n")
    });
    said.collect::<Vec<_>>().join("\n")
}

#[test]
fn rows_that_make_no_maze_are_refused_at_the_cell() {
    let table = r######"
ragged rows: #### #SG# ###
a row that is too long: #### #SG## ####
no rows: {\n  "rows": []\n}
an empty row: ####  ####
no goal: #### #S.# ####
two starts: ##### #S.G# #.S.# #####
two starts in one row: ##### #SSG# #####
an unknown letter: #### #sG# ####
a letter of several bytes: #### #é█# ####
a start that reaches no goal: ##### #S#G# #####
a free cell that reaches no goal when the start is random: ###### #.G#.# ######
no cell to start in: #### #GG# ####
an open border: #### #SG. ####
"######;
    insta::assert_snapshot!(refusals(&cases(table)));
}

#[test]
fn a_floor_that_does_not_fit_the_rows_is_refused_at_the_cell() {
    let table = r######"
a floor of the wrong type: "floor": "ice"
a row of a floor of the wrong type: "floor": ["#..#", 3]
too few rows: "floor": ["####", "#3.#"]
too many rows: "floor": ["####", "#3.#", "####", "####"]
a row that is too short: "floor": ["####", "#3#", "####"]
an unknown letter: "floor": ["####", "#x.#", "####"]
a letter of several bytes: "floor": ["####", "#é.#", "####"]
no friction at all: "floor": ["####", "#0.#", "####"]
a wall where there is none: "floor": ["####", "##3#", "####"]
friction below a wall: "floor": ["####", "#.3#", "#3##"]
"######;
    insta::assert_snapshot!(refusals(&cases(table)));
}

#[test]
fn wrong_keys_and_values_are_refused_at_the_word() {
    let table = r######"
a size of zero: "cell_size_m": 0
a negative size: "cell_size_m": -1.0
a huge size: "cell_size_m": 1e300
an infinite size: "cell_size_m": 1e999
a denormal size: "cell_size_m": 1e-320
a size that is not a number: "cell_size_m": NaN
a size written as minus infinity: "cell_size_m": -Infinity
a size of the wrong type: "cell_size_m": "1.0"
five moves: "moves": 5
wrap of the wrong type: "wrap": "yes"
rows of the wrong type: {\n  "rows": "####"\n}
a row of the wrong type: {\n  "rows": [\n    "####",\n    17\n  ]\n}
a misspelt key: "cellsize": 1.0
an unknown key: "gravity": 9.81
a repeated key: "moves": 4,\n  "moves": 8
a missing key: {\n  "name": "maze"\n}
a name that leaves the folder: "name": "../x"
an absolute path as a name: "name": "/etc/passwd"
a device as a name: "name": "CON"
a nul character in a name: "name": "a\u0000b"
an empty name: "name": ""
a name of the wrong type: "name": 4
half a surrogate pair as a name: "name": "\ud800"
"######;
    insta::assert_snapshot!(refusals(&cases(table)));
}

#[test]
fn text_that_is_not_a_json_object_is_refused_at_the_character() {
    let sound = rows("#### #SG# ####");
    let comma = String::from_utf8_lossy(&sound).replace("  ]\n", "  ],\n");
    let file = |text: &[u8]| text.to_vec();
    let cases = [
        ("text after the world", [&sound[..], b"and more\n"].concat()),
        ("a trailing comma", comma.into()),
        (
            "a trailing comma in an array",
            file(b"{\n  \"rows\": [\"####\", ]\n}\n"),
        ),
        (
            "a line break in a string",
            file(b"{\n  \"rows\": [\"##\\\"\n##\"]\n}\n"),
        ),
        (
            "a fault at the end of a line",
            file(b"{\n  \"rows\": tru\n}\n"),
        ),
        (
            "an unfinished file",
            file(b"{\n  \"rows\": [\n    \"####\",\n"),
        ),
        ("a missing colon", file(b"{\n  \"rows\" []\n}\n")),
        (
            "an array instead of the object",
            file(b"[\n  \"####\"\n]\n"),
        ),
        ("an empty file", Vec::new()),
        (
            "a nul byte",
            file(b"{\n  \"rows\": [\"####\", \"#S\0G#\"]\n}"),
        ),
        (
            "bytes that are no UTF-8",
            file(b"{\n  \"rows\": [\"####\", \"#S\xffG#\"]\n}"),
        ),
        (
            "a fault after a byte order mark and windows line ends",
            file(b"\xef\xbb\xbf{\r\n  \"rows\": [\r\n    \"####\",\r\n    \"#x\"]\r\n}"),
        ),
    ];
    insta::assert_snapshot!(refusals(&cases));
}

#[test]
fn what_is_too_large_is_refused() {
    let many_rows = format!("{{\"rows\": [{}]}}", vec!["\"\""; 4097].join(","));
    let many_columns = format!("{{\"rows\": [\"{}\"]}}", ".".repeat(4097));
    let nested = vec![b'['; 100_000];
    let cases = [
        ("deep nesting", [&b"{\"rows\":"[..], &nested].concat()),
        ("nesting from the first byte", nested),
        ("too many rows", many_rows.into()),
        ("too many columns", many_columns.into()),
        ("more than 64 MiB", vec![b' '; (64 << 20) + 1]),
    ];
    insta::assert_snapshot!(refusals(&cases));
}

/// One file of each table, and those that ask most of the program: the main thread's stack, and
/// the whole size of a file.
#[test]
fn the_program_prints_what_the_library_says_and_ends_with_code_65() {
    let folder = tempfile::tempdir().unwrap();
    for (fault, text) in [
        ("ragged rows", rows("#### #SG# ###")),
        ("a misspelt key", with(r#""cellsize": 1.0"#)),
        ("bytes that are no UTF-8", b"{\"rows\": [\"\xff".to_vec()),
        ("nesting", vec![b'['; 100_000]),
        ("more than 64 MiB", vec![b' '; (64 << 20) + 1]),
    ] {
        fs::write(folder.path().join("bad.json"), &text).unwrap();
        let mut check = xcscr(&["world", "check", "bad.json"]);
        let output = check.current_dir(folder.path()).output().unwrap();
        let (stdout, stderr) = ended(&output, 65, fault);
        assert_eq!(stdout, "", "{fault}");
        let said = refusal(fault, &text);
        assert_eq!(stderr, format!("error: {said}\n"), "{fault}");
    }
}
