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
        let pair = |cell: Cell| [cell.col, cell.row];
        let kept = KeptWorld {
            name: self.name().to_owned(),
            moves: self.action_count(),
            wrap: self.wraps(),
            start: self.start().map(pair),
            goals: self.goals().iter().copied().map(pair).collect(),
            floor: self.floor_rows(),
            rewarding: self.rewarding_cells().iter().copied().map(pair).collect(),
            reward: self
                .rewarding_cells()
                .first()
                .and_then(|&cell| self.auxiliary_reward(cell)),
        };
        let mut yaml = String::new();
        let _ = write!(
            yaml,
            "image: {}\nmode: trinary\nresolution: {:?}\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n\
             occupied_thresh: 0.65\nfree_thresh: 0.25\n\
             # What other programs ignore: the rest of the world, for the way back.\n\
             xcscr:\n  name: {}\n  moves: {}\n  wrap: {}\n  start: {}\n  goals: {:?}\n",
            quoted(image),
            self.cell_size_m(),
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
            let _ = writeln!(
                yaml,
                "  rewarding: {:?}\n  reward: {reward:?}",
                kept.rewarding
            );
        }
        let mut pgm = format!("P5\n{} {}\n255\n", self.width(), self.height()).into_bytes();
        pgm.extend(
            self.cells()
                .map(|cell| if self.is_wall(cell) { WALL } else { FREE }),
        );
        WrittenMap { yaml, image: pgm }
    }
}

/// A text as YAML has it in double quotes, which is also JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
