//! Every kind of bad world file ends with code 65 and a message that points at the place.
//!
//! Each test is named after the fault, and shows the file and the whole message.

use std::fs;

use assert_cmd::Command;
use insta::assert_snapshot;

/// What `world check` says about a file with this text; panics unless it refuses it properly.
fn refusal(text: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bad.json"), text).unwrap();
    let output = Command::cargo_bin("xcscr")
        .unwrap()
        .args(["world", "check", "bad.json"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(65), "{stderr}");
    assert!(output.stdout.is_empty(), "{:?}", output.stdout);
    assert!(!stderr.contains("panicked"), "{stderr}");
    assert!(!stderr.contains('\x1b'), "no colours in a file: {stderr:?}");
    stderr
}

#[test]
fn ragged_rows() {
    let text = r#####"{
  "rows": [
    "####",
    "#SG#",
    "###"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#####"
    error: row 3 has 3 cells, expected 4
     --> bad.json:5:6
      |
    5 |     "###"
      |      ^^^ 3 cells
      |
     ::: bad.json:3:6
      |
    3 |     "####",
      |      ---- 4 cells
      |
      = help: add 1 cell to row 3
    "#####);
}

#[test]
fn a_row_that_is_too_long() {
    let text = r#####"{
  "rows": [
    "####",
    "#SG##",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#####"
    error: row 2 has 5 cells, expected 4
     --> bad.json:4:6
      |
    4 |     "#SG##",
      |      ^^^^^ 5 cells
      |
     ::: bad.json:3:6
      |
    3 |     "####",
      |      ---- 4 cells
      |
      = help: remove 1 cell from row 2
    "#####);
}

#[test]
fn no_goal() {
    let text = r#####"{
  "rows": [
    "####",
    "#S.#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: the world has no goal
     --> bad.json:2:11
      |
    2 |   "rows": [
      |           ^ no `G` in these rows
      |
      = help: mark at least one cell with `G`
    "#);
}

#[test]
fn two_starts() {
    let text = r######"{
  "rows": [
    "#####",
    "#S.G#",
    "#.S.#",
    "#####"
  ]
}
"######;
    assert_snapshot!(refusal(text.as_bytes()), @r##"
    error: the world has two starts
     --> bad.json:5:8
      |
    5 |     "#.S.#",
      |        ^ another start
      |
     ::: bad.json:4:7
      |
    4 |     "#S.G#",
      |       - the first start
      |
      = help: keep one `S`; without any, every episode starts in a random free cell
    "##);
}

#[test]
fn two_starts_in_one_row() {
    let text = r######"{
  "rows": [
    "#####",
    "#SSG#",
    "#####"
  ]
}
"######;
    assert_snapshot!(refusal(text.as_bytes()), @r##"
    error: the world has two starts
     --> bad.json:4:8
      |
    4 |     "#SSG#",
      |       -^ another start
      |       |
      |       the first start
      |
      = help: keep one `S`; without any, every episode starts in a random free cell
    "##);
}

#[test]
fn an_unknown_letter() {
    let text = r#####"{
  "rows": [
    "####",
    "#sG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r##"
    error: row 2 has the unknown letter `s`
     --> bad.json:4:7
      |
    4 |     "#sG#",
      |       ^ unknown letter
      |
      = help: did you mean `S`? the letters are `#` wall, `.` free, `S` start, `G` goal
    "##);
}

#[test]
fn a_letter_of_several_bytes() {
    let text = r#####"{
  "rows": [
    "####",
    "#é█#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r##"
    error: row 2 has the unknown letter `é`
     --> bad.json:4:7
      |
    4 |     "#é█#",
      |       ^ unknown letter
      |
      = help: the letters are `#` wall, `.` free, `S` start, `G` goal
    "##);
}

#[test]
fn an_escape_sequence_in_a_row() {
    let text = r#####"{
  "rows": [
    "####",
    "#\u0053G#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r##"
    error: row 2 has the unknown letter `\`
     --> bad.json:4:7
      |
    4 |     "#\u0053G#",
      |       ^ unknown letter
      |
      = help: rows have no escape sequences; the letters are `#` wall, `.` free, `S` start, `G` goal
    "##);
}

#[test]
fn a_start_that_reaches_no_goal() {
    let text = r######"{
  "rows": [
    "#####",
    "#S#G#",
    "#####"
  ]
}
"######;
    assert_snapshot!(refusal(text.as_bytes()), @r##"
    error: no goal can be reached from the start
     --> bad.json:4:7
      |
    4 |     "#S#G#",
      |       ^ cut off from every goal
      |
      = help: open a wall on the way, or move `S` or `G`
    "##);
}

#[test]
fn a_free_cell_that_reaches_no_goal_when_the_start_is_random() {
    let text = r#######"{
  "rows": [
    "######",
    "#.G#.#",
    "######"
  ]
}
"#######;
    assert_snapshot!(refusal(text.as_bytes()), @r##"
    error: no goal can be reached from a free cell, and episodes start in any of them
     --> bad.json:4:10
      |
    4 |     "#.G#.#",
      |          ^ cut off from every goal
      |
      = help: make the cell a wall, open a way, or set a fixed start `S`
    "##);
}

#[test]
fn no_cell_to_start_in() {
    let text = r#####"{
  "rows": [
    "####",
    "#GG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r##"
    error: the world has no cell to start in
     --> bad.json:4:7
      |
    4 |     "#GG#",
      |       ^ there is no free cell beside the goals
      |
      = help: mark a start with `S`, or free a cell with `.`
    "##);
}

#[test]
fn an_open_border() {
    let text = r#####"{
  "rows": [
    "####",
    "#SG.",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r##"
    error: the border is open
     --> bad.json:4:9
      |
    4 |     "#SG.",
      |         ^ expected a wall `#`
      |
      = help: close the border with `#`, or join the edges with "wrap": true
    "##);
}

#[test]
fn a_size_of_zero() {
    let text = r#####"{
  "cell_size_m": 0,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `cell_size_m` is `0`, but must be from 0.1 to 10
     --> bad.json:2:18
      |
    2 |   "cell_size_m": 0,
      |                  ^ out of range
      |
      = help: `cell_size_m` is the edge of a cell in metres; leave it out for 1.0
    "#);
}

#[test]
fn a_negative_size() {
    let text = r#####"{
  "cell_size_m": -1.0,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `cell_size_m` is `-1.0`, but must be from 0.1 to 10
     --> bad.json:2:18
      |
    2 |   "cell_size_m": -1.0,
      |                  ^^^^ out of range
      |
      = help: `cell_size_m` is the edge of a cell in metres; leave it out for 1.0
    "#);
}

#[test]
fn a_huge_size() {
    let text = r#####"{
  "cell_size_m": 1e300,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `cell_size_m` is `1e300`, but must be from 0.1 to 10
     --> bad.json:2:18
      |
    2 |   "cell_size_m": 1e300,
      |                  ^^^^^ out of range
      |
      = help: `cell_size_m` is the edge of a cell in metres; leave it out for 1.0
    "#);
}

#[test]
fn an_infinite_size() {
    let text = r#####"{
  "cell_size_m": 1e999,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `cell_size_m` is `1e999`, but must be from 0.1 to 10
     --> bad.json:2:18
      |
    2 |   "cell_size_m": 1e999,
      |                  ^^^^^ out of range
      |
      = help: `cell_size_m` is the edge of a cell in metres; leave it out for 1.0
    "#);
}

#[test]
fn a_denormal_size() {
    let text = r#####"{
  "cell_size_m": 1e-320,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `cell_size_m` is `1e-320`, but must be from 0.1 to 10
     --> bad.json:2:18
      |
    2 |   "cell_size_m": 1e-320,
      |                  ^^^^^^ out of range
      |
      = help: `cell_size_m` is the edge of a cell in metres; leave it out for 1.0
    "#);
}

#[test]
fn a_size_that_is_not_a_number() {
    let text = r#####"{
  "cell_size_m": NaN,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: JSON knows only finite numbers
     --> bad.json:2:18
      |
    2 |   "cell_size_m": NaN,
      |                  ^ not a number
      |
      = help: write a finite number, such as 1.0
    "#);
}

#[test]
fn a_size_written_as_minus_infinity() {
    let text = r#####"{
  "cell_size_m": -Infinity,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: JSON knows only finite numbers
     --> bad.json:2:19
      |
    2 |   "cell_size_m": -Infinity,
      |                   ^ not a number
      |
      = help: write a finite number, such as 1.0
    "#);
}

#[test]
fn a_size_of_the_wrong_type() {
    let text = r#####"{
  "cell_size_m": "1.0",
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#####"
    error: `cell_size_m` is a string, expected a number
     --> bad.json:2:18
      |
    2 |   "cell_size_m": "1.0",
      |                  ^^^^^ expected a number
      |
      = help: a world looks like this: { "name": "tiny", "rows": ["####", "#SG#", "####"] }
    "#####);
}

#[test]
fn five_moves() {
    let text = r#####"{
  "moves": 5,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `moves` is `5`, expected 4 or 8
     --> bad.json:2:12
      |
    2 |   "moves": 5,
      |            ^ expected 4 or 8
      |
      = help: 4 means north, east, south and west; 8 adds the diagonals
    "#);
}

#[test]
fn wrap_of_the_wrong_type() {
    let text = r#####"{
  "wrap": "yes",
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#####"
    error: `wrap` is a string, expected true or false
     --> bad.json:2:11
      |
    2 |   "wrap": "yes",
      |           ^^^^^ expected true or false
      |
      = help: a world looks like this: { "name": "tiny", "rows": ["####", "#SG#", "####"] }
    "#####);
}

#[test]
fn a_misspelt_key() {
    let text = r#####"{
  "cellsize": 1.0,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: the key `cellsize` is unknown
     --> bad.json:2:3
      |
    2 |   "cellsize": 1.0,
      |   ^^^^^^^^^^ no such key in a world
      |
      = help: did you mean `cell_size_m`?
    "#);
}

#[test]
fn an_unknown_key() {
    let text = r#####"{
  "gravity": 9.81,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: the key `gravity` is unknown
     --> bad.json:2:3
      |
    2 |   "gravity": 9.81,
      |   ^^^^^^^^^ no such key in a world
      |
      = help: the keys of a world are `name`, `cell_size_m`, `moves`, `wrap`, `rows`
    "#);
}

#[test]
fn a_repeated_key() {
    let text = r#####"{
  "moves": 4,
  "moves": 8,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: the key `moves` is repeated
     --> bad.json:3:3
      |
    3 |   "moves": 8,
      |   ^^^^^^^ again here
      |
     ::: bad.json:2:3
      |
    2 |   "moves": 4,
      |   ------- first here
      |
      = help: keep one `moves` and remove the other
    "#);
}

#[test]
fn a_missing_key() {
    let text = r#"{
  "name": "maze"
}
"#;
    assert_snapshot!(refusal(text.as_bytes()), @r#####"
    error: the world has no `rows`
     --> bad.json:1:1
      |
    1 | {
      | ^ `rows` is missing in this object
      |
      = help: a world looks like this: { "name": "tiny", "rows": ["####", "#SG#", "####"] }
    "#####);
}

#[test]
fn text_after_the_world() {
    let text = r#####"{
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
and more
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r"
    error: there is text after the end of the world
     --> bad.json:8:1
      |
    8 | and more
      | ^ the world ended before this
      |
      = help: remove everything after the closing `}`
    ");
}

#[test]
fn a_trailing_comma() {
    let text = r#####"{
  "rows": [
    "####",
    "#SG#",
    "####"
  ],
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r"
    error: there is a comma before a closing bracket
     --> bad.json:6:4
      |
    6 |   ],
      |    ^ nothing follows
      |
      = help: remove the comma
    ");
}

#[test]
fn an_unfinished_file() {
    let text = r#####"{
  "rows": [
    "####",
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: the file ends in the middle of the world
     --> bad.json:4:1
      |
    4 |
      | ^ the file ends here
      |
      = help: add what is missing: every `"`, `[` and `{` needs its partner
    "#);
}

#[test]
fn a_missing_colon() {
    let text = r#"{
  "rows" []
}
"#;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: the file is not valid JSON
     --> bad.json:2:10
      |
    2 |   "rows" []
      |          ^ expected `:`
      |
      = help: see json.org for the rules; the usual causes are missing quotes, commas and brackets
    "#);
}

#[test]
fn an_array_instead_of_the_object() {
    let text = r#####"[
  "####"
]
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#####"
    error: the file holds an array, expected an object
     --> bad.json:1:1
      |
    1 | [
      | ^ expected `{`
      |
      = help: a world is one JSON object: { "name": "tiny", "rows": ["####", "#SG#", "####"] }
    "#####);
}

#[test]
fn rows_of_the_wrong_type() {
    let text = r#####"{
  "rows": "####"
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#####"
    error: `rows` is a string, expected an array of strings
     --> bad.json:2:11
      |
    2 |   "rows": "####"
      |           ^^^^^^ expected an array of strings
      |
      = help: a world looks like this: { "name": "tiny", "rows": ["####", "#SG#", "####"] }
    "#####);
}

#[test]
fn a_row_of_the_wrong_type() {
    let text = r#####"{
  "rows": [
    "####",
    17
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#####"
    error: `rows[1]` is a number, expected a string
     --> bad.json:4:5
      |
    4 |     17
      |     ^^ expected a string
      |
      = help: a world looks like this: { "name": "tiny", "rows": ["####", "#SG#", "####"] }
    "#####);
}

#[test]
fn no_rows() {
    let text = r#"{
  "rows": []
}
"#;
    assert_snapshot!(refusal(text.as_bytes()), @r####"
    error: the world has no rows
     --> bad.json:2:11
      |
    2 |   "rows": []
      |           ^^ no row
      |
      = help: give at least three rows, such as "###", "#G#", "###"
    "####);
}

#[test]
fn an_empty_row() {
    let text = r#####"{
  "rows": [
    "####",
    "",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: row 2 is empty
     --> bad.json:4:5
      |
    4 |     "",
      |     ^^ no cell
      |
      = help: a row is a string of `#`, `.`, `S` and `G`; remove the empty one
    "#);
}

#[test]
fn an_empty_file() {
    let text = r"";
    assert_snapshot!(refusal(text.as_bytes()), @r#####"
    error: the file is empty
     --> bad.json:1:1
      |
    1 |
      | ^ expected a world here
      |
      = help: a world is one JSON object: { "name": "tiny", "rows": ["####", "#SG#", "####"] }
    "#####);
}

#[test]
fn a_name_that_leaves_the_folder() {
    let text = r#####"{
  "name": "../x",
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `../x` cannot be the name of a world
     --> bad.json:2:11
      |
    2 |   "name": "../x",
      |           ^^^^^^ write for example "x"
      |
      = help: a name has 1 to 64 letters (a to z, A to Z), digits, `-`, `_` or `.`, no dot at either end, and is no device name such as `CON`
    "#);
}

#[test]
fn an_absolute_path_as_a_name() {
    let text = r#####"{
  "name": "/etc/passwd",
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `/etc/passwd` cannot be the name of a world
     --> bad.json:2:11
      |
    2 |   "name": "/etc/passwd",
      |           ^^^^^^^^^^^^^ write for example "etc-passwd"
      |
      = help: a name has 1 to 64 letters (a to z, A to Z), digits, `-`, `_` or `.`, no dot at either end, and is no device name such as `CON`
    "#);
}

#[test]
fn a_device_as_a_name() {
    let text = r#####"{
  "name": "CON",
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `CON` cannot be the name of a world
     --> bad.json:2:11
      |
    2 |   "name": "CON",
      |           ^^^^^ write for example "my-maze"
      |
      = help: a name has 1 to 64 letters (a to z, A to Z), digits, `-`, `_` or `.`, no dot at either end, and is no device name such as `CON`
    "#);
}

#[test]
fn a_nul_character_in_a_name() {
    let text = r#####"{
  "name": "a\u0000b",
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `a\0b` cannot be the name of a world
     --> bad.json:2:11
      |
    2 |   "name": "a\u0000b",
      |           ^^^^^^^^^^ write for example "a-b"
      |
      = help: a name has 1 to 64 letters (a to z, A to Z), digits, `-`, `_` or `.`, no dot at either end, and is no device name such as `CON`
    "#);
}

#[test]
fn an_empty_name() {
    let text = r#####"{
  "name": "",
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `` cannot be the name of a world
     --> bad.json:2:11
      |
    2 |   "name": "",
      |           ^^ write for example "my-maze"
      |
      = help: a name has 1 to 64 letters (a to z, A to Z), digits, `-`, `_` or `.`, no dot at either end, and is no device name such as `CON`
    "#);
}

#[test]
fn a_name_of_the_wrong_type() {
    let text = r#####"{
  "name": 4,
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#####"
    error: `name` is a number, expected a string
     --> bad.json:2:11
      |
    2 |   "name": 4,
      |           ^ expected a string
      |
      = help: a world looks like this: { "name": "tiny", "rows": ["####", "#SG#", "####"] }
    "#####);
}

#[test]
fn half_a_surrogate_pair_as_a_name() {
    let text = r#####"{
  "name": "\ud800",
  "rows": [
    "####",
    "#SG#",
    "####"
  ]
}
"#####;
    assert_snapshot!(refusal(text.as_bytes()), @r#"
    error: `"\ud800"` cannot be the name of a world
     --> bad.json:2:11
      |
    2 |   "name": "\ud800",
      |           ^^^^^^^^ write for example "ud800"
      |
      = help: a name has 1 to 64 letters (a to z, A to Z), digits, `-`, `_` or `.`, no dot at either end, and is no device name such as `CON`
    "#);
}

#[test]
fn a_nul_byte() {
    assert_snapshot!(refusal(b"{\n  \"rows\": [\"####\", \"#S\0G#\"]\n}"), @r#####"
    error: there is a control character in a string
     --> bad.json:2:23
      |
    2 |   "rows": ["####", "#S␀G#"]
      |                       ^ not allowed here
      |
      = help: remove it; a line break within a text is written `\n`
    "#####);
}

#[test]
fn bytes_that_are_no_utf_8() {
    assert_snapshot!(refusal(b"{\n  \"rows\": [\"####\", \"#S\xffG#\"]\n}"), @r#####"
    error: the file is not UTF-8 text
     --> bad.json:2:23
      |
    2 |   "rows": ["####", "#S�G#"]
      |                       ^ byte 0xff cannot stand here
      |
      = help: save the file as UTF-8
    "#####);
}

#[test]
fn a_fault_after_a_byte_order_mark_and_windows_line_ends() {
    assert_snapshot!(refusal(b"\xef\xbb\xbf{\r\n  \"rows\": [\r\n    \"####\",\r\n    \"#x\"]\r\n}"), @r##"
    error: row 2 has the unknown letter `x`
     --> bad.json:4:7
      |
    4 |     "#x"]
      |       ^ unknown letter
      |
      = help: did you mean `#`? the letters are `#` wall, `.` free, `S` start, `G` goal
    "##);
}

#[test]
fn deep_nesting() {
    assert_snapshot!(refusal(&[b"{\"rows\":".to_vec(), vec![b'['; 100_000]].concat()), @r#"
    error: the file ends in the middle of the world
     --> bad.json:1:100008
      |
    1 | ...[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[
      |                                                           ^ the file ends here
      |
      = help: add what is missing: every `"`, `[` and `{` needs its partner
    "#);
}

#[test]
fn nesting_from_the_first_byte() {
    assert_snapshot!(refusal(&vec![b'['; 100_000]), @r#####"
    error: the file holds an array, expected an object
     --> bad.json:1:1
      |
    1 | [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[...
      | ^ expected `{`
      |
      = help: a world is one JSON object: { "name": "tiny", "rows": ["####", "#SG#", "####"] }
    "#####);
}

#[test]
fn too_many_rows() {
    assert_snapshot!(refusal(format!("{{\"rows\": [{}]}}", vec!["\"\""; 4097].join(",")).as_bytes()), @r#"
    error: the world has 4097 rows, at most 4096 are possible
     --> bad.json:1:10
      |
    1 | ...": ["","","","","","","","","","","","","","",""...","","","","","","","","","","","","","","","
      |       ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^...^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ too many
      |
      = help: a world has at most 4096 columns and 4096 rows
    "#);
}

#[test]
fn too_many_columns() {
    assert_snapshot!(refusal(format!("{{\"rows\": [\"{}\"]}}", ".".repeat(4097)).as_bytes()), @r#"
    error: row 1 has 4097 cells, at most 4096 are possible
     --> bad.json:1:11
      |
    1 | ...: ["..........................................................................................."]}
      |       ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^...^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ too many
      |
      = help: a world has at most 4096 columns and 4096 rows
    "#);
}

#[test]
fn more_than_64_mib() {
    assert_snapshot!(refusal(&vec![b' '; (64 << 20) + 1]), @r"
    error: the world file is larger than 64 MiB
    --> bad.json
     = help: a world file has at most 64 MiB; split the world or make it smaller
    ");
}

#[test]
fn two_places_far_apart_in_one_long_line() {
    let first = "#".repeat(4000);
    let text = format!(
        r####"{{"rows": ["{}", "###"]}}"####,
        vec![first; 10].join("\", \"")
    );
    let message = refusal(text.as_bytes());
    assert!(
        message.contains("row 11 has 3 cells, expected 4000"),
        "{message}"
    );
    assert!(message.contains("bad.json:1:40052"), "{message}");
    assert!(message.contains(" 3 cells\n"), "{message}");
    assert!(message.contains(" 4000 cells\n"), "{message}");
}
