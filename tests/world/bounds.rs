//! The bounds of worlds, against brute force and against figures of an earlier computation.

use std::collections::BTreeMap;

use xcscr::sensor::Sensor;
use xcscr::trial::Bounds;
use xcscr::world::{Cell, Maze};
use xcscr::xcs::{Action, Percept};

use crate::kit::trial::maze;
use crate::worlds::drawn;

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

/// The least mean steps of a policy with one action for each percept: all are tried.
fn brute_memoryless(sensor: Sensor, maze: &Maze) -> f64 {
    let percepts = sensor.percepts(maze);
    let actions = maze.action_count();
    let cells: Vec<Cell> = maze.free_cells().collect();
    let number = |cell: Cell| cells.iter().position(|other| *other == cell).unwrap();
    let looks = cells.iter().map(|&cell| sensor.perceive_at(maze, cell));
    let looks: Vec<Result<usize, usize>> =
        looks.map(|look| percepts.binary_search(&look)).collect();
    let next = |cell: &Cell| {
        let row = Action::all(actions).map(|action| number(moved(maze, *cell, action)));
        row.collect::<Vec<usize>>()
    };
    let next: Vec<Vec<usize>> = cells.iter().map(next).collect();
    let starts: Vec<usize> = maze.start_cells().into_iter().map(number).collect();
    let goals: Vec<bool> = cells.iter().map(|&cell| maze.is_goal(cell)).collect();
    let steps = |policy: usize, start: usize| {
        let (mut cell, mut steps) = (start, 0_u32);
        // More steps than there are cells are a circle.
        while !goals[cell] && steps as usize <= cells.len() {
            let action = policy / actions.pow(looks[cell].unwrap() as u32) % actions;
            cell = next[cell][action];
            steps += 1;
        }
        if goals[cell] { steps } else { 100 }
    };
    let policies = 0..actions.pow(percepts.len() as u32);
    let sum = |policy| {
        starts
            .iter()
            .map(|&start| steps(policy, start))
            .sum::<u32>()
    };
    f64::from(policies.map(sum).min().unwrap()) / starts.len() as f64
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
        let bounds = Bounds::new(maze, sensor, 0.0);
        let starts = maze.start_cells();
        let groups = by_percept(sensor, maze, &starts);
        let sums = groups
            .values()
            .map(|group| brute_belief(sensor, maze, group, 6).unwrap());
        let belief = f64::from(sums.sum::<u32>()) / starts.len() as f64;
        assert_eq!(bounds.belief.unwrap().steps, belief, "{}", maze.to_json());
        let memoryless = bounds.memoryless.unwrap();
        let expected = brute_memoryless(sensor, maze);
        let found = (memoryless.steps, memoryless.error);
        assert_eq!(found, (expected, 0.0), "{}", maze.to_json());
    }
}

/// A quarter of the moves are drawn from all eight: so many are others than the chosen one.
const SLIP: f64 = 0.25 * 7.0 / 8.0;

/// Full, belief and memoryless bounds without slip.
#[rustfmt::skip]
const TABLE: [(&str, f64, f64, f64); 8] = [
    ("littman57", 3.71, 3.71, 3.7),
    ("littman89", 3.77, 3.77, 3.8),
    ("woods100", 2.00, 2.33, 34.5),
    ("woods101", 2.70, 2.90, 41.5),
    ("woods102", 2.77, 3.23, 40.5),
    ("maze10", 4.56, 5.06, 57.1),
    ("maze7", 4.11, 4.33, 24.9),
    ("mazef8", 8.17, 9.83, 37.3),
];

#[test]
fn the_bounds_of_classic_mazes_are_those_of_an_earlier_program() {
    for (name, full, belief, memoryless) in TABLE {
        let maze = maze(&format!("classic/{name}"));
        let found = Bounds::new(&maze, Sensor::Neighbours, 0.0);
        for (found, expected, digits) in [
            (found.full, full, 0.01),
            (found.belief.unwrap().steps, belief, 0.01),
            (found.memoryless.unwrap().steps, memoryless, 0.1),
        ] {
            let off = (found - expected).abs();
            assert!(off < 0.6 * digits, "{name}: {found}, not {expected}");
        }
    }
}

#[test]
fn the_belief_bound_of_slipping_moves_is_an_estimate_with_its_error() {
    let bounds = Bounds::new(&maze("classic/woods101"), Sensor::Neighbours, SLIP);
    let belief = bounds.belief.unwrap();
    let off = (belief.steps - 4.06).abs();
    assert!(off < 0.02 + belief.error, "{belief:?}");
    assert!(belief.error > 0.0 && belief.error < 0.12, "{belief:?}");
    // Exact, and as in the earlier computation.
    assert!((bounds.full - 3.72).abs() < 0.006, "{bounds:?}");
    assert!(belief.steps > bounds.full && bounds.memoryless.is_none());
}

#[test]
fn where_the_start_is_fixed_nothing_has_to_be_found_out() {
    let maze = tiny(4, &["#########", "#..SG...#", "#########"]);
    let bounds = Bounds::new(&maze, Sensor::Neighbours, 0.0);
    assert_eq!((bounds.full, bounds.belief.unwrap().steps), (1.0, 1.0));
}
