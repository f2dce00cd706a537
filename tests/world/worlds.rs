//! Facts about the shipped worlds, all of them computed.

use std::fs;
use std::path::{Path, PathBuf};

use xcscr::agent::Method;
use xcscr::arena::{ArenaKind, View};
use xcscr::episode::{Observer, Step};
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, Trial};
use xcscr::world::{Cell, Facts, Maze, Moves, Paths, WorldError};

fn shipped(name: &str) -> Maze {
    let path = root().join(format!("worlds/{name}.json"));
    Maze::load(&path).unwrap_or_else(|error| panic!("{error}"))
}

/// Shortest length and number of shortest paths from the start.
fn shortest(name: &str) -> (u32, u64) {
    let maze = shipped(name);
    let start = maze.start().expect("a fixed start");
    let paths = Paths::new(&maze);
    let length = paths.distance(&maze, start).expect("a way to the goal");
    (length, paths.count_from(&maze, start))
}

#[test]
fn maze4_takes_ten_steps_on_three_shortest_paths() {
    assert_eq!(shortest("maze4"), (10, 3));
}

#[test]
fn maze5_takes_twelve_steps_on_one_shortest_path() {
    assert_eq!(shortest("maze5"), (12, 1));
}

#[test]
fn maze6_takes_twelve_steps_on_two_shortest_paths() {
    assert_eq!(shortest("maze6"), (12, 2));
}

#[test]
fn classic_maze4_takes_three_and_a_half_steps_on_average_from_26_cells() {
    // The optimum that the literature on learning classifier systems gives for Maze4.
    let maze = shipped("maze4-classic");
    assert_eq!(maze.start_cells().len(), 26);
    assert_eq!(Facts::new(&maze).mean_optimal_steps, 3.5);
}

#[test]
fn woods1_is_a_torus_of_five_by_five_with_16_cells_and_1_7_steps_on_average() {
    // Wilson (1994) gives 1.7 steps as the optimum.
    let maze = shipped("woods1");
    assert_eq!((maze.width(), maze.height(), maze.wraps()), (5, 5, true));
    assert_eq!(maze.start_cells().len(), 16);
    assert_eq!(Facts::new(&maze).mean_optimal_steps, 27.0 / 16.0);
}

#[test]
fn no_two_cells_of_the_classic_worlds_look_alike() {
    for name in ["maze4-classic", "woods1"] {
        assert_eq!(Sensor::Neighbours.alike(&shipped(name)), [], "{name}");
    }
}

#[test]
fn two_cells_of_maze4_look_alike_because_of_the_goal_in_the_corner() {
    let groups = Sensor::Neighbours.alike(&shipped("maze4"));
    let cells: Vec<_> = groups.iter().map(|group| group.cells.clone()).collect();
    let pair = vec![Cell { col: 5, row: 2 }, Cell { col: 4, row: 5 }];
    assert_eq!(cells, [pair], "{groups:?}");
}

#[test]
fn every_shipped_world_is_named_like_its_file() {
    for path in files() {
        let maze = Maze::load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(Some(maze.name()), path.file_stem().and_then(|s| s.to_str()));
    }
}

#[test]
fn every_shipped_world_agrees_with_the_schema() {
    let schema = json(&root().join("assets/world.schema.json"));
    let required = schema["required"].as_array().unwrap();
    for path in files() {
        let world = json(&path);
        let world = world.as_object().unwrap();
        for key in world.keys() {
            let known = schema["properties"].get(key).is_some();
            assert!(known, "{} has the unknown key {key}", path.display());
        }
        for key in required {
            let there = world.contains_key(key.as_str().unwrap());
            assert!(there, "{} lacks {key}", path.display());
        }
    }
}

#[test]
fn the_schema_knows_the_same_keys_as_the_program() {
    let schema = json(&root().join("assets/world.schema.json"));
    let error = Maze::from_json(br#"{"gravity": 9.81}"#, "test.json").unwrap_err();
    let message = error.to_string();
    let listed = message.split("the keys of a world are ").nth(1).unwrap();
    let mut listed: Vec<&str> = listed.split(", ").map(|k| k.trim_matches('`')).collect();
    listed.sort_unstable();
    let mut keys: Vec<&str> = schema["properties"]
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    keys.sort_unstable();
    assert_eq!(listed, keys);
    assert_eq!(schema["additionalProperties"], false);
}

#[test]
fn what_a_file_leaves_out_has_its_default() {
    let maze = Maze::from_json(
        br#"{"wrap": true, "rows": ["S.G", "G.."]}"#,
        "dir/tiny.json",
    )
    .unwrap();
    assert_eq!(maze.name(), "tiny");
    assert_eq!(maze.cell_size_m(), 1.0);
    assert_eq!(maze.moves(), Moves::Four);
    assert_eq!(maze.goals().len(), 2);
}

/// Counts auxiliary rewards, and what the method made of each.
#[derive(Default)]
struct Purse {
    in_this_episode: u32,
    most_in_an_episode: u32,
    paid: Vec<f64>,
}

impl Observer for Purse {
    fn began(&mut self, _: u32, _: &View<'_>) {
        self.in_this_episode = 0;
    }

    fn stepped(&mut self, step: &Step<'_>) {
        if step.outcome.found() > 0.0 {
            self.in_this_episode += 1;
            self.most_in_an_episode = self.most_in_an_episode.max(self.in_this_episode);
            self.paid.push(step.credit.short_term_reward);
        }
    }
}

#[test]
fn every_method_is_paid_what_a_cell_pays_once_in_an_episode() {
    for &method in Method::ALL {
        let mut purse = Purse::default();
        let rows = ["#####", "#S*G#", "#####"];
        let text = format!(r#"{{ "rows": {rows:?}, "reward": 100 }}"#);
        let maze = Maze::from_json(text.as_bytes(), "corridor").unwrap();
        let plan = Plan::new(maze).method(method).episodes(5);
        let mut trial = Trial::new(plan.arena(ArenaKind::Grid)).unwrap();
        let _ = trial.run(&mut purse);
        let (most, paid) = (purse.most_in_an_episode, &purse.paid);
        // A step costs 1, the cell pays 100.
        assert!(
            most == 1 && paid.iter().all(|&one| one == 99.0),
            "{method:?}: {most} {paid:?}"
        );
    }
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_are_accepted() {
    let text = fs::read_to_string(root().join("worlds/maze4.json")).unwrap();
    let text = format!("\u{feff}{}", text.replace('\n', "\r\n"));
    let maze = Maze::from_json(text.as_bytes(), "windows.json").unwrap();
    assert_eq!(maze, shipped("maze4"));
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
    let text = format!(r#"{{"rows": {rows:?}}}"#);
    let facts = Facts::new(&Maze::from_json(text.as_bytes(), "hall.json").unwrap());
    assert_eq!(facts.optimal_steps, Some(198));
    assert_eq!(facts.optimal_paths, Some(u64::MAX));
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// The shipped world files, in the order of their names.
fn files() -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join("worlds")).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = paths.filter(|path| path.is_file()).collect();
    files.sort();
    files
}
