//! The bounds of worlds, against brute force and against figures of an earlier computation.

use std::collections::BTreeMap;

use xcscr::sensor::Sensor;
use xcscr::trial::Bounds;
use xcscr::world::{Cell, Maze};
use xcscr::xcs::{Action, Percept};

use crate::kit::trial::maze;
use crate::world::worlds::drawn;

fn tiny(moves: u8, rows: &[&str]) -> Maze {
    drawn(serde_json::json!({ "moves": moves }), rows)
}

fn moved(maze: &Maze, cell: Cell, action: Action) -> Cell {
    let direction = maze.direction(action).unwrap();
    maze.step(cell, direction).unwrap_or(cell)
}

fn by_percept(sensor: Sensor, maze: &Maze, cells: &[Cell]) -> BTreeMap<Percept, Vec<Cell>> {
    let mut groups: BTreeMap<Percept, Vec<Cell>> = BTreeMap::new();
    for &cell in cells {
        let percept = sensor.perceive_at(maze, cell);
        groups.entry(percept).or_default().push(cell);
    }
    groups
}

/// The least sum of steps from some cells that share a percept: all sequences of actions and percepts up to
/// a depth are tried; `None` if none of them gets everywhere to a goal.
fn brute_belief(sensor: Sensor, maze: &Maze, cells: &[Cell], depth: u32) -> Option<u32> {
    let left = depth.checked_sub(1)?;
    let after = |action| {
        let reached: Vec<Cell> = cells
            .iter()
            .map(|&cell| moved(maze, cell, action))
            .collect();
        let open: Vec<Cell> = reached
            .into_iter()
            .filter(|&cell| !maze.is_goal(cell))
            .collect();
        let groups = by_percept(sensor, maze, &open);
        let sums = groups
            .values()
            .map(|group| brute_belief(sensor, maze, group, left));
        sums.sum::<Option<u32>>()
    };
    let least = Action::all(maze.action_count()).filter_map(after).min()?;
    Some(least + cells.len() as u32)
}

#[test]
fn the_bounds_of_tiny_worlds_are_those_of_brute_force() {
    let worlds = [
        tiny(4, &["#########", "#...G...#", "#########"]),
        tiny(4, &["########", "#..G...#", "########"]),
        tiny(4, &["#####", "#.#.#", "#...#", "#G#.#", "#####"]),
        tiny(8, &["#####", "#..G#", "#####"]),
    ];
    let sensors = [Sensor::Neighbours, Sensor::Lidar];
    let each = worlds
        .iter()
        .flat_map(|maze| sensors.map(|sensor| (maze, sensor)));
    for (maze, sensor) in each {
        let bounds = Bounds::new(maze, sensor);
        let starts = maze.start_cells();
        let groups = by_percept(sensor, maze, &starts);
        let sums = groups
            .values()
            .map(|group| brute_belief(sensor, maze, group, 6).unwrap());
        let belief = f64::from(sums.sum::<u32>()) / starts.len() as f64;
        assert_eq!(bounds.unknown_start, Some(belief), "{}", maze.to_json());
    }
}

/// Full-state and unknown-start optima.
const TABLE: [(&str, f64, f64); 8] = [
    ("littman57", 3.71, 3.71),
    ("littman89", 3.77, 3.77),
    ("woods100", 2.00, 2.33),
    ("woods101", 2.70, 2.90),
    ("woods102", 2.77, 3.23),
    ("maze10", 4.56, 5.06),
    ("maze7", 4.11, 4.33),
    ("mazef8", 8.17, 9.83),
];

#[test]
fn the_bounds_of_classic_mazes_are_those_of_an_earlier_program() {
    for (name, full, unknown_start) in TABLE {
        let maze = maze(&format!("classic/{name}"));
        let found = Bounds::new(&maze, Sensor::Neighbours);
        for (found, expected) in [
            (found.full, full),
            (found.unknown_start.unwrap(), unknown_start),
        ] {
            let off = (found - expected).abs();
            assert!(off < 0.006, "{name}: {found}, not {expected}");
        }
    }
}

#[test]
fn where_the_start_is_fixed_nothing_has_to_be_found_out() {
    let maze = tiny(4, &["#########", "#..SG...#", "#########"]);
    let bounds = Bounds::new(&maze, Sensor::Neighbours);
    assert_eq!((bounds.full, bounds.unknown_start), (1.0, Some(1.0)));
}
