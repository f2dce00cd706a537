//! Writes a maze as an occupancy map of one pixel per cell, and reads it back.
//!
//! The grey level of a pixel contains everything about its cell, so a map that was edited with an
//! image editor is still a world. All other data is in the YAML file.

use std::fmt::Write;

use serde::Deserialize;

use super::{MapError, OccupancyMap};
use crate::world::{Cell, Maze};

/// The grey level of walls, as Nav2 saves it.
const WALL: u8 = 0;
/// The grey level of a free cell, as Nav2 saves it. Marked cells are darker, but still free for
/// Nav2.
const FREE: u8 = 254;
/// The contents of a free cell: its letter in a world file. Each takes [`FLOORS`] grey levels.
const LETTERS: [char; 4] = ['.', 'S', 'G', '*'];
/// The usual floor, and friction from 1 to 9 tenths.
const FLOORS: u8 = 10;

/// The two files of a map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrittenMap {
    /// The YAML file.
    pub yaml: String,
    /// The image that the YAML file names (PGM, P5).
    pub image: Vec<u8>,
}

/// The data of a maze beyond its cells, under the key `xcscr` of the YAML file. Other programs
/// ignore it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SavedWorld {
    name: String,
    /// 4 or 8.
    moves: usize,
    /// True if opposite edges are joined.
    wrap: bool,
    /// The reward of each marked cell.
    #[serde(default)]
    reward: Option<f64>,
}

impl Maze {
    /// Returns the maze as an occupancy map of one pixel per cell. The caller saves the image next
    /// to the YAML file under the name `image`. The map has the origin of the maze.
    pub fn to_map(&self, image: &str) -> WrittenMap {
        let mut pgm = format!("P5\n{} {}\n255\n", self.width(), self.height()).into_bytes();
        pgm.extend(self.cells().map(|cell| grey(self, cell)));
        WrittenMap {
            yaml: yaml(self, image),
            image: pgm,
        }
    }
}

fn yaml(maze: &Maze, image: &str) -> String {
    let mut yaml = String::new();
    let _ = write!(
        yaml,
        "image: {}\nmode: trinary\nresolution: {:?}\norigin: {:?}\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n\
         # For xcscr: data of the world that the grey levels do not contain.\n\
         xcscr:\n  name: {}\n  moves: {}\n  wrap: {}\n",
        quoted(image),
        maze.cell_size_m(),
        <[f64; 3]>::from(maze.origin()),
        quoted(maze.name()),
        maze.action_count(),
        maze.wraps(),
    );
    let rewarding = maze.rewarding_cells().first();
    if let Some(reward) = rewarding.and_then(|&cell| maze.auxiliary_reward(cell)) {
        let _ = writeln!(yaml, "  reward: {reward:?}");
    }
    yaml
}

/// Returns the grey level of a cell.
fn grey(maze: &Maze, cell: Cell) -> u8 {
    if maze.is_wall(cell) {
        return WALL;
    }
    let letter = match () {
        () if maze.start() == Some(cell) => 1,
        () if maze.is_goal(cell) => 2,
        () if maze.auxiliary_reward(cell).is_some() => 3,
        () => 0,
    };
    let tenths = maze
        .friction(cell)
        .map_or(0, |friction| (friction * 10.0).round() as u8);
    FREE - letter * FLOORS - tenths
}

/// Returns the letter of a free cell for a grey level, and the friction of its floor in tenths, 0
/// for the usual floor.
fn letter(grey: u8) -> (char, u8) {
    let level = FREE.wrapping_sub(grey);
    let letter = LETTERS.get(usize::from(level / FLOORS));
    letter.map_or(('.', 0), |&letter| (letter, level % FLOORS))
}

impl SavedWorld {
    /// Restores the maze that was written as this map, including later changes to the image.
    pub fn restored(&self, map: &OccupancyMap, greys: &[u8]) -> Result<Maze, MapError> {
        let (mut rows, mut floor) = (Vec::new(), Vec::new());
        for row in 0..map.height {
            let cells = (0..map.width).map(|col| match map.is_free(col, row) {
                true => letter(greys[row * map.width + col]),
                false => ('#', 0),
            });
            let (letters, tenths): (String, Vec<u8>) = cells.unzip();
            let of_floor = letters.chars().zip(tenths).map(|cell| match cell {
                ('#', _) => '#',
                (_, 0) => '.',
                (_, tenths) => char::from(b'0' + tenths),
            });
            floor.push(of_floor.collect::<String>());
            rows.push(letters);
        }
        let mut world = serde_json::json!({
            "name": self.name,
            "cell_size_m": map.resolution_m,
            "moves": self.moves,
            "wrap": self.wrap,
            "origin": map.origin,
            "floor": floor,
        });
        if rows.iter().any(|row| row.contains('*')) {
            world["reward"] = self.reward.into();
        }
        world["rows"] = rows.into();
        Ok(Maze::from_json(
            world.to_string().as_bytes(),
            "the converted map",
        )?)
    }
}

/// Formats a text as a YAML string in double quotes, which is also JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
