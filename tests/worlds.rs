//! Facts about the shipped worlds, all of them computed.

use std::path::Path;

use xcscr::world::{Maze, Paths};

fn shipped(name: &str) -> Maze {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("worlds/{name}.json"));
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
