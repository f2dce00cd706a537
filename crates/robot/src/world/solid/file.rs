//! The key `solid` of world files.

use std::fmt::Write;

use serde::Deserialize;

use super::Solid;
use crate::world::Origin;
use crate::world::error::{Fault, quoted};
use crate::world::maze::Maze;

/// The smallest and the largest edge of a pixel, in metres, as in maps.
const PIXEL_M: std::ops::RangeInclusive<f64> = 0.001..=10.0;
/// The smallest and the largest radius of a disc on its way between cells, in metres.
const RADIUS_M: std::ops::RangeInclusive<f64> = 0.01..=10.0;
/// The largest number of pixels: those of the largest map, and the border around them.
const MAX_PIXELS: usize = 65_000_000;
const HELP: &str = "`solid` is the true shape of the walls: `pixel_m`, `corner`, `radius_m` and \
                    `rows`, written by `xcscr world convert`; convert the map again";

/// The value of the key.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::world) struct Keys {
    pixel_m: f64,
    corner: Origin,
    radius_m: f64,
    /// From the top. Each row lists runs of pixels: their number, then `#` if they are solid, or
    /// `.` if they are free.
    rows: Vec<String>,
}

impl Solid {
    /// Checks the key of the world `maze`, whose cells are already read.
    pub(in crate::world) fn of_keys(keys: Keys, maze: &Maze) -> Result<Self, Fault> {
        let solid = Self::from_keys(keys).and_then(|solid| solid.checked(maze));
        solid.map_err(|fault| {
            let title = format!("`solid` is not the geometry of this world: {fault}");
            Fault::new(title, HELP)
        })
    }

    fn from_keys(keys: Keys) -> Result<Self, String> {
        if !PIXEL_M.contains(&keys.pixel_m) {
            let (least, most) = (PIXEL_M.start(), PIXEL_M.end());
            return Err(format!(
                "`pixel_m` is {}, but must be from {least} to {most}",
                keys.pixel_m
            ));
        }
        if let Some(fault) = keys.corner.fault() {
            return Err(format!("`corner`: {fault}"));
        }
        if !RADIUS_M.contains(&keys.radius_m) {
            let (least, most) = (RADIUS_M.start(), RADIUS_M.end());
            return Err(format!(
                "`radius_m` is {}, but must be from {least} to {most}",
                keys.radius_m
            ));
        }
        let mut bits = Vec::new();
        let mut width = 0;
        for (number, text) in keys.rows.iter().enumerate() {
            let before = bits.len();
            read_row(text, &mut bits).map_err(|fault| format!("row {}: {fault}", number + 1))?;
            let found = bits.len() - before;
            width = if number == 0 { found } else { width };
            if found != width || found == 0 {
                return Err(format!(
                    "row {} has {found} pixels, the first one {width}",
                    number + 1
                ));
            }
        }
        if bits.is_empty() {
            return Err("it has no rows".to_owned());
        }
        Ok(Self {
            radius_m: keys.radius_m,
            ..Self::new(width, bits.into(), keys.pixel_m, keys.corner)
        })
    }

    /// Requires that the disc is clear in the middle of every free cell.
    fn checked(self, maze: &Maze) -> Result<Self, String> {
        let is_wrong = |&cell: &_| !self.is_clear(maze.centre_in_grid(cell), self.radius_m);
        match maze.free_cells().find(is_wrong) {
            None => Ok(self),
            Some(cell) => Err(format!(
                "the middle of the free cell in column {}, row {} is not clear of walls",
                cell.col, cell.row
            )),
        }
    }

    /// Returns the value of the key as JSON, each row in a line of its own.
    pub(in crate::world) fn to_json(&self) -> String {
        let rows: Vec<String> = self
            .bits
            .chunks(self.width)
            .map(|row| format!("      \"{}\"", runs(row)))
            .collect();
        format!(
            "{{\n    \"pixel_m\": {:?},\n    \"corner\": {:?},\n    \"radius_m\": {:?},\n    \"rows\": [\n{}\n    ]\n  }}",
            self.pixel_m,
            <[f64; 3]>::from(self.corner),
            self.radius_m,
            rows.join(",\n"),
        )
    }
}

/// Reads the runs of a row.
fn read_row(text: &str, bits: &mut Vec<bool>) -> Result<(), String> {
    for run in text.split_inclusive(['#', '.']) {
        let bad = || format!("{} is not a run such as `12#` or `3.`", quoted(run));
        let (count, is_solid) = match run.strip_suffix('#') {
            Some(count) => (count, true),
            None => (run.strip_suffix('.').ok_or_else(bad)?, false),
        };
        let count: usize = count.parse().map_err(|_| bad())?;
        if bits.len().saturating_add(count) > MAX_PIXELS {
            return Err(format!("more than {MAX_PIXELS} pixels in all"));
        }
        bits.resize(bits.len() + count, is_solid);
    }
    Ok(())
}

/// Writes the runs of a row.
fn runs(row: &[bool]) -> String {
    let mut text = String::new();
    for run in row.chunk_by(|one, other| one == other) {
        let letter = if run[0] { '#' } else { '.' };
        let _ = write!(text, "{}{letter}", run.len());
    }
    text
}

#[cfg(test)]
mod tests {
    use crate::world::Maze;

    fn maze(solid: &str) -> Result<Maze, String> {
        let text = format!(r######"{{ "rows": ["####", "#SG#", "####"], "solid": {solid} }}"######);
        Maze::from_json(text.as_bytes(), "hall.json").map_err(|error| error.to_string())
    }

    const GOOD: &str = r#"{ "pixel_m": 0.5, "corner": [0.5, 0.5, 0.0], "radius_m": 0.3,
        "rows": ["6#", "1#4.1#", "1#4.1#", "6#"] }"#;

    #[test]
    fn a_geometry_is_written_and_read_as_the_same_pixels() {
        let first = maze(GOOD).unwrap();
        let solid = first.solid();
        assert_eq!((solid.size(), solid.pixel_m()), ([6, 4], 0.5));
        assert!(first.is_from_map());
        let again = Maze::from_json(first.to_json().as_bytes(), "hall.json").unwrap();
        assert_eq!(again, first);
        assert_eq!(again.to_json(), first.to_json());
    }

    #[test]
    fn a_maze_has_its_cells_as_geometry_and_writes_none() {
        let text = br######"{ "rows": ["####", "#SG#", "####"] }"######;
        let maze = Maze::from_json(text, "hall.json").unwrap();
        assert!(!maze.is_from_map() && !maze.to_json().contains("solid"));
        let solid = maze.solid();
        assert_eq!((solid.size(), solid.pixel_m()), ([4, 3], 1.0));
        assert!(solid.is_solid(0, 1) && !solid.is_solid(1, 1) && solid.is_solid(-1, 1));
    }

    #[test]
    fn a_damaged_geometry_is_refused_with_its_fault() {
        for (from, to, fault) in [
            (
                r#""1#4.1#", "#,
                r#""1#3.1#", "#,
                "row 2 has 5 pixels, the first one 6",
            ),
            ("6#", "6", "row 1: "),
            ("6#", "99999999999#", "more than 65000000 pixels"),
            ("6#", "", "row 1 has 0 pixels"),
            ("0.5,", "0,", "`pixel_m` is 0"),
            ("0.3,", "0,", "`radius_m` is 0"),
            ("[0.5, 0.5, 0.0]", "[0.5, 0.5]", "invalid length 2"),
            ("[0.5, 0.5, 0.0]", "[0.5, 0.5, 99.0]", "`corner`"),
            (
                "[0.5, 0.5, 0.0]",
                "[1.5, 0.5, 0.0]",
                "column 1, row 1 is not clear",
            ),
            ("corner", "edge", "unknown field `edge`"),
            (
                r#""rows": ["6#", "1#4.1#", "1#4.1#", "6#"]"#,
                r#""rows": []"#,
                "no rows",
            ),
        ] {
            assert!(GOOD.contains(from), "{from}");
            let message = maze(&GOOD.replacen(from, to, 1)).unwrap_err();
            assert!(message.contains(fault), "{to}: {message}");
            assert!(message.starts_with("hall.json:"), "{message}");
        }
        assert!(maze("7").unwrap_err().contains("invalid type"));
    }
}
