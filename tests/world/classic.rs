//! The 29 classic mazes: their size, their shortest ways, and what looks alike in them.

use std::fs;

use xcscr::sensor::Sensor;
use xcscr::world::{Cell, Facts, Maze, Moves, Paths};

use crate::kit::trial::maze as shipped;
use crate::world::worlds::{files, root};

/// Name, start cells, steps of the shortest ways from all of them together, and group: computed
/// by another program (breadth-first search over the rows as text).
const FIGURES: [(&str, usize, u32, Group); 29] = [
    ("cassandra4x4", 15, 34, Group::None),
    ("lab1", 76, 850, Group::Three),
    ("littman57", 14, 52, Group::One),
    ("littman89", 22, 83, Group::One),
    ("maze10", 18, 82, Group::Three),
    ("maze4-classic", 26, 91, Group::None),
    ("maze5-classic", 36, 166, Group::None),
    ("maze7", 9, 37, Group::Three),
    ("mazea", 22, 93, Group::None),
    ("mazeb", 25, 87, Group::One),
    ("mazed", 24, 65, Group::One),
    ("mazee1", 44, 108, Group::Two),
    ("mazee2", 48, 112, Group::Two),
    ("mazee3", 80, 240, Group::Three),
    ("mazef1", 5, 9, Group::None),
    ("mazef2", 6, 15, Group::None),
    ("mazef3", 8, 27, Group::None),
    ("mazef4", 10, 43, Group::Three),
    ("mazef8", 18, 147, Group::Three),
    ("mazef9", 23, 199, Group::Three),
    ("miyazakia", 29, 88, Group::One),
    ("miyazakib", 27, 89, Group::Three),
    ("sutton", 46, 298, Group::Three),
    ("woods1-walled", 8, 13, Group::None),
    ("woods100", 6, 12, Group::Two),
    ("woods101", 10, 27, Group::Two),
    ("woods101demi", 20, 56, Group::Two),
    ("woods102", 26, 72, Group::Two),
    ("woods14", 18, 171, Group::None),
];

/// How cells that share a percept differ (Zatuchna and Bagnall 2009).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Group {
    None,
    One,
    Two,
    Three,
}

fn maze(name: &str) -> Maze {
    shipped(&format!("classic/{name}"))
}

/// The last group of which a maze has a pair of cells.
fn group(maze: &Maze) -> Group {
    let paths = Paths::new(maze);
    let groups = Sensor::Neighbours.aliased_cells(maze);
    let pairs = groups.iter().flat_map(|group| {
        let ordered = group
            .cells
            .iter()
            .map(|a| group.cells.iter().map(move |b| (*a, *b)));
        ordered.flatten()
    });
    pairs
        .map(|pair| kind(maze, &paths, pair))
        .max()
        .unwrap_or(Group::None)
}

fn kind(maze: &Maze, paths: &Paths, (a, b): (Cell, Cell)) -> Group {
    let best = |cell, action| paths.successor(maze, cell, action).is_some();
    let mut actions = xcscr::xcs::Action::all(maze.action_count());
    let shared = actions.any(|action| best(a, action) && best(b, action));
    match (paths.distance(maze, a) == paths.distance(maze, b), shared) {
        (true, true) => Group::None,
        (false, true) => Group::One,
        (true, false) => Group::Two,
        (false, false) => Group::Three,
    }
}

#[test]
fn every_classic_maze_has_the_figures_of_an_independent_computation() {
    for (name, starts, steps, expected) in FIGURES {
        let maze = maze(name);
        let facts = Facts::new(&maze);
        assert_eq!(maze.name(), name);
        assert_eq!((maze.moves(), maze.start()), (Moves::Eight, None), "{name}");
        assert_eq!(maze.start_cells().len(), starts, "{name}");
        let sum = facts.mean_optimal_steps * starts as f64;
        assert!((sum - f64::from(steps)).abs() < 1e-6, "{name}: {sum} steps");
        assert_eq!(group(&maze), expected, "{name}");
    }
}

#[test]
fn every_file_of_the_folder_has_figures_and_the_readme_lists_each_in_its_group() {
    assert_eq!(files("worlds/classic").len(), FIGURES.len());
    let readme = fs::read_to_string(root().join("worlds/classic/README.md")).unwrap();
    for (name, .., group) in FIGURES {
        let head = ["| not aliased |", "| I |", "| II |", "| III |"][group as usize];
        let row = readme.lines().find(|line| line.starts_with(head)).unwrap();
        assert!(row.contains(&format!("`{name}`")), "{name} is not in {row}");
    }
    assert_eq!(maze("maze4-classic"), shipped("maze4-classic"));
}
