//! A maze as an occupancy map: one pixel per cell.

use std::fmt::Write;

use super::KeptWorld;
use crate::world::{Cell, Maze};

/// Grey levels of free cells and of walls, as Nav2 saves them.
const FREE: u8 = 254;
const WALL: u8 = 0;

/// The two files of a map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrittenMap {
    /// The YAML file.
    pub yaml: String,
    /// The image that it names (PGM, P5).
    pub image: Vec<u8>,
}

impl Maze {
    /// The maze as an occupancy map, whose image will lie beside the YAML file under the name `image`.
    pub fn to_map(&self, image: &str) -> WrittenMap {
        WrittenMap {
            yaml: yaml(self, &KeptWorld::of(self), image),
            image: pgm(self),
        }
    }
}

impl KeptWorld {
    fn of(maze: &Maze) -> Self {
        let pair = |cell: Cell| [cell.col, cell.row];
        let rewarding = maze.rewarding_cells();
        Self {
            name: maze.name().to_owned(),
            moves: maze.action_count(),
            wrap: maze.wraps(),
            start: maze.start().map(pair),
            goals: maze.goals().iter().copied().map(pair).collect(),
            floor: maze.floor_rows(),
            rewarding: rewarding.iter().copied().map(pair).collect(),
            reward: rewarding
                .first()
                .and_then(|&cell| maze.auxiliary_reward(cell)),
        }
    }
}

fn yaml(maze: &Maze, kept: &KeptWorld, image: &str) -> String {
    let mut yaml = String::new();
    let _ = write!(
        yaml,
        "image: {}\nmode: trinary\nresolution: {:?}\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.25\n\
         # What other programs ignore: the rest of the world, for the way back.\n\
         xcscr:\n  name: {}\n  moves: {}\n  wrap: {}\n  start: {}\n  goals: {:?}\n",
        quoted(image),
        maze.cell_size_m(),
        quoted(&kept.name),
        kept.moves,
        kept.wrap,
        kept.start
            .map_or("null".to_owned(), |start| format!("{start:?}")),
        kept.goals
    );
    if let Some(floor) = &kept.floor {
        let _ = writeln!(yaml, "  floor: {floor:?}");
    }
    if let Some(reward) = kept.reward {
        let rewarding = &kept.rewarding;
        let _ = writeln!(yaml, "  rewarding: {rewarding:?}\n  reward: {reward:?}");
    }
    yaml
}

/// The image: one pixel per cell.
fn pgm(maze: &Maze) -> Vec<u8> {
    let mut pgm = format!("P5\n{} {}\n255\n", maze.width(), maze.height()).into_bytes();
    let pixels = maze.cells();
    pgm.extend(pixels.map(|cell| if maze.is_wall(cell) { WALL } else { FREE }));
    pgm
}

/// A text as YAML has it in double quotes, which is also JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
