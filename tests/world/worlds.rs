//! Facts about the shipped worlds, all of them computed.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;
use xcscr::sensor::Sensor;
use xcscr::world::{Cell, Facts, Maze, Moves, WorldError};

use crate::kit::trial::maze;

#[test]
fn the_shipped_mazes_have_the_shortest_paths_of_the_papers() {
    // Lengths and numbers of the shortest paths from the start.
    for (name, length, number) in [("maze4", 10, 3), ("maze5", 12, 1), ("maze6", 12, 2)] {
        let facts = Facts::new(&maze(name));
        let found = (facts.optimal_steps, facts.optimal_paths);
        assert_eq!(found, (Some(length), Some(number)), "{name}");
    }
    // The literature on learning classifier systems gives 3.5 steps as the optimum for Maze4, and Wilson (1994)
    // 1.7 for Woods1, a torus of five by five.
    for (name, cells, mean) in [("maze4-classic", 26, 3.5), ("woods1", 16, 27.0 / 16.0)] {
        let maze = maze(name);
        assert_eq!(maze.start_cells().len(), cells, "{name}");
        assert_eq!(Facts::new(&maze).mean_optimal_steps, mean, "{name}");
        assert_eq!(Sensor::Neighbours.aliased_cells(&maze), [], "{name}");
    }
    let woods1 = maze("woods1");
    assert_eq!(
        (woods1.width(), woods1.height(), woods1.wraps()),
        (5, 5, true)
    );
}

#[test]
fn two_cells_of_maze4_look_alike_because_of_the_goal_in_the_corner() {
    let groups = Sensor::Neighbours.aliased_cells(&maze("maze4"));
    let cells: Vec<_> = groups.iter().map(|group| group.cells.clone()).collect();
    let pair = vec![Cell { col: 5, row: 2 }, Cell { col: 4, row: 5 }];
    assert_eq!(cells, [pair], "{groups:?}");
}

#[test]
fn every_shipped_world_is_named_like_its_file_and_has_the_keys_of_the_schema() {
    let schema = read(&root().join("assets/world.schema.json"));
    for path in files("worlds") {
        let maze = Maze::load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(Some(maze.name()), path.file_stem().and_then(|s| s.to_str()));
        let world = read(&path);
        for key in schema["required"].as_array().unwrap() {
            let there = world.get(key.as_str().unwrap()).is_some();
            assert!(there, "{} lacks {key}", path.display());
        }
    }
    // The program, which refuses other keys, knows the same ones.
    let error = Maze::from_json(br#"{"gravity": 9.81}"#, "test.json").unwrap_err();
    let message = error.to_string();
    let listed = message.split("expected one of ").nth(1).unwrap();
    let listed = listed.split("; ").next().unwrap().split(", ");
    let listed = listed.map(|key| key.trim_matches('`'));
    let listed: BTreeSet<&str> = listed.collect();
    let keys = schema["properties"].as_object().unwrap().keys();
    let keys: BTreeSet<&str> = keys.map(String::as_str).collect();
    assert_eq!(listed, keys);
    assert_eq!(schema["additionalProperties"], false);
}

#[test]
fn what_a_file_leaves_out_has_its_default() {
    let text = br#"{"wrap": true, "rows": ["S.G", "G.."]}"#;
    let maze = Maze::from_json(text, "dir/tiny.json").unwrap();
    let found = (maze.name(), maze.cell_size_m(), maze.moves());
    assert_eq!(found, ("tiny", 1.0, Moves::Four));
    assert_eq!(maze.goals().len(), 2);
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_are_accepted() {
    let text = fs::read_to_string(root().join("worlds/maze4.json")).unwrap();
    let text = format!("\u{feff}{}", text.replace('\n', "\r\n"));
    let maze = Maze::from_json(text.as_bytes(), "windows.json").unwrap();
    assert_eq!(maze, crate::kit::trial::maze("maze4"));
}

#[test]
fn a_missing_file_is_told_apart_from_one_that_cannot_be_read() {
    let missing = Maze::load(&root().join("worlds/none.json")).unwrap_err();
    assert!(matches!(missing, WorldError::Missing { .. }), "{missing}");
    let folder = Maze::load(&root().join("worlds")).unwrap_err();
    assert!(matches!(folder, WorldError::Unreadable { .. }), "{folder}");
}

#[test]
fn paths_in_a_large_open_hall_are_counted_up_to_the_largest_number() {
    let wall = "#".repeat(102);
    let mut rows = vec![format!("#{}#", ".".repeat(100)); 102];
    (rows[0], rows[101]) = (wall.clone(), wall);
    rows[1].replace_range(1..2, "S");
    rows[100].replace_range(100..101, "G");
    let facts = Facts::new(&drawn(json!({}), &rows));
    assert_eq!(facts.optimal_steps, Some(198));
    assert_eq!(facts.optimal_paths, Some(u64::MAX));
}

/// Returns a world of these rows, and of other keys of its file.
pub fn drawn(mut keys: serde_json::Value, rows: &[impl AsRef<str>]) -> Maze {
    keys["rows"] = rows.iter().map(AsRef::as_ref).collect::<Vec<_>>().into();
    Maze::from_json(keys.to_string().as_bytes(), "drawn.json").unwrap()
}

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Returns the world files of a folder, in the order of their names.
pub fn files(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let is_world = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "json");
    let mut files: Vec<PathBuf> = paths.filter(is_world).collect();
    files.sort();
    files
}
