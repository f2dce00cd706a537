//! Facts about a maze that are known before learning.

use serde::Serialize;

use super::maze::{Cell, Maze};
use super::origin::Origin;
use super::paths::Paths;

/// Size, starts, goals and shortest paths of a maze; steps are moves from cell to cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Facts {
    /// The world's name.
    pub world: String,
    /// Columns.
    pub width: u16,
    /// Rows.
    pub height: u16,
    /// Edge length of a cell in metres.
    pub cell_size_m: f64,
    /// The number of actions, 4 or 8.
    pub moves: usize,
    /// True if the edges join.
    pub wrap: bool,
    /// The pose of the south-western corner in the map frame; absent if it is the map's origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin: Option<Origin>,
    /// The number of free cells, including goals.
    pub free_cells: usize,
    /// The start; `None` when each episode starts in a random free cell.
    pub start: Option<Cell>,
    /// The goals in reading order.
    pub goals: Vec<Cell>,
    /// The floors that differ from the usual one, most slippery first; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub floors: Vec<FloorFacts>,
    /// The length of a shortest path from the fixed start, in steps.
    pub optimal_steps: Option<u32>,
    /// The number of different shortest paths from the fixed start.
    pub optimal_paths: Option<u64>,
    /// The mean length of the shortest paths over all cells in which an episode can start.
    pub mean_optimal_steps: f64,
    /// The largest of these lengths.
    pub greatest_optimal_steps: u32,
}

/// The number of cells with a given floor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FloorFacts {
    /// Friction between wheels and floor.
    pub friction: f64,
    /// The number of cells with this friction.
    pub cells: usize,
}

impl Facts {
    /// Computes the facts about a maze.
    pub fn new(maze: &Maze) -> Self {
        let paths = Paths::new(maze);
        let steps = |cell| paths.distance(maze, cell);
        let lengths = || maze.starts().filter_map(steps);
        let sum: f64 = lengths().map(f64::from).sum();
        Self {
            world: maze.name().to_owned(),
            width: maze.width(),
            height: maze.height(),
            cell_size_m: maze.cell_size_m(),
            moves: maze.action_count(),
            wrap: maze.wraps(),
            origin: Some(maze.origin()).filter(|&origin| origin != Origin::default()),
            free_cells: maze.free_cells().count(),
            start: maze.start(),
            goals: maze.goals().to_vec(),
            floors: floors(maze),
            optimal_steps: maze.start().and_then(steps),
            optimal_paths: maze.start().map(|start| paths.count_from(maze, start)),
            mean_optimal_steps: sum / lengths().count() as f64,
            greatest_optimal_steps: lengths().max().unwrap_or(0),
        }
    }
}

/// Counts the cells of each floor.
fn floors(maze: &Maze) -> Vec<FloorFacts> {
    let frictions: Vec<f64> = maze
        .free_cells()
        .filter_map(|cell| maze.friction(cell))
        .collect();
    let tenths = (1..=9).map(|tenths| f64::from(tenths) / 10.0);
    let count = |friction: f64| FloorFacts {
        friction,
        cells: frictions.iter().filter(|&&other| other == friction).count(),
    };
    tenths.map(count).filter(|floor| floor.cells > 0).collect()
}
