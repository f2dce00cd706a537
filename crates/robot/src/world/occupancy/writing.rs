//! Writes a maze as an occupancy map of one pixel per cell, and reads it back.
//!
//! The YAML file contains the world file of the maze. The image says where walls are, so a map that
//! was edited with an image editor is still a world.

use std::fmt::Write;

use serde_json::Value;

use super::{MapError, OccupancyMap};
use crate::world::Maze;

/// The grey level of walls, as Nav2 saves it.
const WALL: u8 = 0;
/// The grey level of free cells, as Nav2 saves it.
const FREE: u8 = 254;

/// The two files of a map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrittenMap {
    /// The YAML file.
    pub yaml: String,
    /// The image that the YAML file names (PGM, P5).
    pub image: Vec<u8>,
}

impl Maze {
    /// Returns the maze as an occupancy map of one pixel per cell. The caller saves the image next
    /// to the YAML file under the name `image`. The map has the origin of the maze.
    pub fn to_map(&self, image: &str) -> WrittenMap {
        let mut pgm = format!("P5\n{} {}\n255\n", self.width(), self.height()).into_bytes();
        let grey = |cell| if self.is_wall(cell) { WALL } else { FREE };
        pgm.extend(self.cells().map(grey));
        WrittenMap {
            yaml: self.map_yaml(image),
            image: pgm,
        }
    }

    fn map_yaml(&self, image: &str) -> String {
        // A JSON string is also a YAML string.
        let mut yaml = format!(
            "image: {}\nmode: trinary\nresolution: {:?}\norigin: {:?}\nnegate: 0\n\
             occupied_thresh: 0.65\nfree_thresh: 0.196\n\
             # For xcscr: the world file of this map. The image decides where walls are.\nxcscr: |\n",
            Value::from(image),
            self.cell_size_m(),
            <[f64; 3]>::from(self.origin()),
        );
        for line in self.to_json().lines() {
            let _ = writeln!(yaml, "  {line}");
        }
        yaml
    }
}

impl OccupancyMap {
    /// Restores the maze whose world file is `world`, with the walls, origin and cell size of this
    /// map.
    pub(super) fn restored(&self, world: &str) -> Result<Maze, MapError> {
        const NAME: &str = "the world in the map";
        let saved = Maze::from_json(world.as_bytes(), NAME)?;
        let size = [saved.width(), saved.height()].map(usize::from);
        if size != [self.width, self.height] {
            return Err(MapError::Cell(format!(
                "the image has {} x {} pixels, but the world in the map has {} x {} cells: give a goal \
                 by `--goal X,Y`, or restore the size of the image",
                self.width, self.height, size[0], size[1]
            )));
        }
        let world = serde_json::from_str(&saved.to_json());
        let mut world: Value = world.expect("a world file is JSON");
        for key in ["rows", "floor"] {
            let Some(rows) = world.get_mut(key).and_then(Value::as_array_mut) else {
                continue;
            };
            for (row, letters) in rows.iter_mut().enumerate() {
                let cells = letters.as_str().unwrap_or_default().chars().enumerate();
                let painted = cells.map(|(col, letter)| match (self.is_free(col, row), letter) {
                    (false, _) => '#',
                    (true, '#') => '.',
                    (true, letter) => letter,
                });
                *letters = painted.collect::<String>().into();
            }
        }
        Ok(Maze::from_json(world.to_string().as_bytes(), NAME)?)
    }
}
