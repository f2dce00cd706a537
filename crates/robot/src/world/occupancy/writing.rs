//! Writes a maze as an occupancy map, and reads it back.
//!
//! The YAML file contains the world file of the maze. The image says where walls are, so a map that
//! was edited with an image editor is still a world.

use std::fmt::Write;
use std::sync::Arc;

use serde_json::Value;

use super::{MapError, Occupancy, OccupancyMap};
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
    /// Returns the maze as an occupancy map: one pixel per cell, or in a world from a map the pixels
    /// of its walls. The caller saves the image next to the YAML file under the name `image`.
    pub fn to_map(&self, image: &str) -> WrittenMap {
        let solid = self.solid();
        let [width, height] = solid.size();
        let mut pgm = format!("P5\n{width} {height}\n255\n").into_bytes();
        let grey = |&is_solid: &bool| if is_solid { WALL } else { FREE };
        pgm.extend(solid.bits.iter().map(grey));
        WrittenMap {
            yaml: self.map_yaml(image),
            image: pgm,
        }
    }

    fn map_yaml(&self, image: &str) -> String {
        let solid = self.solid();
        // A JSON string is also a YAML string.
        let mut yaml = format!(
            "image: {}\nmode: trinary\nresolution: {:?}\norigin: {:?}\nnegate: 0\n\
             occupied_thresh: 0.65\nfree_thresh: 0.196\n\
             # For xcscr: the world file of this map. The image decides where walls are.\nxcscr: |\n",
            Value::from(image),
            solid.pixel_m(),
            <[f64; 3]>::from(self.origin().followed_by(solid.corner)),
        );
        for line in self.to_json().lines() {
            let _ = writeln!(yaml, "  {line}");
        }
        yaml
    }
}

impl OccupancyMap {
    /// Restores the maze whose world file is `world`, with the walls of this map.
    pub(super) fn restored(&self, world: &str) -> Result<Maze, MapError> {
        const NAME: &str = "the world in the map";
        let saved = Maze::from_json(world.as_bytes(), NAME)?;
        let size = saved.solid().size();
        if size != [self.width, self.height] {
            return Err(MapError::Cell(format!(
                "the image has {} x {} pixels, but the world in the map has {} x {}: give a goal by \
                 `--goal X,Y`, or restore the size of the image",
                self.width, self.height, size[0], size[1]
            )));
        }
        if saved.is_from_map() {
            return self.with_these_pixels(saved);
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

    /// Returns a world from a map with the pixels of this map, which may have been edited.
    fn with_these_pixels(&self, saved: Maze) -> Result<Maze, MapError> {
        let is_solid = |occupancy| occupancy != Occupancy::Free;
        let bits: Arc<[bool]> = self.occupancies().map(is_solid).collect();
        if bits == saved.solid().bits {
            return Ok(saved);
        }
        let edited = saved.with_solid(saved.solid().with_bits(bits));
        edited.ok_or(MapError::CutOff(None))
    }
}
