//! Reads, checks and writes world files.

use std::io;
use std::path::Path;
use std::sync::Arc;

use super::checks::{check_border, check_reachable, check_start_and_goal};
use super::direction::Moves;
use super::document::Document;
use super::error::WorldError;
use super::floor;
use super::json::{kind, missing_key, wrong_type};
use super::maze::Maze;
use super::name;
use super::near;
use super::origin::Origin;
use super::rows::Rows;
use super::solid::Solid;
use super::source::{Source, quoted};
use crate::input;

/// The largest world file, in bytes.
const MAX_BYTES: u64 = 64 << 20;
/// The smallest and the largest edge of a cell, in metres.
const CELL_SIZE_M: std::ops::RangeInclusive<f64> = 0.1..=10.0;

impl Maze {
    /// Reads and checks a world file. A file without a name gives its own name to the world.
    ///
    /// # Errors
    /// [`WorldError::Missing`], [`WorldError::Unreadable`], or [`WorldError::Invalid`] as in
    /// [`Maze::from_json`].
    pub fn load(path: &Path) -> Result<Self, WorldError> {
        let text = input::read(path, MAX_BYTES).map_err(|source| match source.kind() {
            io::ErrorKind::NotFound => WorldError::Missing {
                path: path.into(),
                near: near::worlds(path),
            },
            io::ErrorKind::FileTooLarge => too_large(&path.to_string_lossy()),
            _ => WorldError::Unreadable {
                path: path.into(),
                source,
            },
        })?;
        Self::from_json(&text, &path.to_string_lossy())
    }

    /// Reads and checks the text of a world file. `origin` is the file's name: messages begin with
    /// it, and its stem is the world's name if the text has none.
    ///
    /// # Errors
    /// [`WorldError::Invalid`] for the first fault of the text:
    ///
    /// * no JSON object, unknown, repeated or missing keys, wrong types, or values out of range
    /// * ragged or empty rows, unknown letters, or an open border
    /// * no goal, more than one start, or a start from which no goal can be reached
    /// * a floor that does not fit the rows, or rewarding cells without a reward
    /// * a solid geometry that does not fit the cells
    /// * too large (over 64 MiB, or 4096 columns or rows)
    ///
    /// # Example
    /// ```
    /// use xcscr_robot::world::{Maze, Paths};
    ///
    /// let text = br#"{ "wrap": true, "rows": ["S..G."] }"#;
    /// let maze = Maze::from_json(text, "ring.json")?;
    /// let start = maze.start().expect("the file has an `S`");
    /// assert_eq!(Paths::new(&maze).distance(&maze, start), Some(2));
    /// # Ok::<(), xcscr_robot::world::WorldError>(())
    /// ```
    pub fn from_json(text: &[u8], origin: &str) -> Result<Self, WorldError> {
        if text.len() as u64 > MAX_BYTES {
            return Err(too_large(origin));
        }
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let source = Source {
            origin,
            text: decode(text, origin)?,
        };
        read_maze(source)
    }

    /// Returns the text of a world file for this maze. Equal mazes give the same text.
    pub fn to_json(&self) -> String {
        let moves = self.action_count();
        let letter = |&wall: &bool| if wall { b'#' } else { b'.' };
        let mut letters: Vec<u8> = self.walls.iter().map(letter).collect();
        self.goals
            .iter()
            .for_each(|&goal| letters[self.index(goal)] = b'G');
        self.start
            .iter()
            .for_each(|&start| letters[self.index(start)] = b'S');
        let rows = letters
            .chunks(usize::from(self.width))
            .map(|row| String::from_utf8_lossy(row).into_owned());
        let floor = self.floor_rows().map_or(String::new(), |rows| {
            format!(",\n  \"floor\": {}", array(rows.into_iter()))
        });
        let origin = match self.origin == Origin::default() {
            true => String::new(),
            false => format!(",\n  \"origin\": {:?}", <[f64; 3]>::from(self.origin)),
        };
        let solid = match self.is_from_map() {
            true => format!(",\n  \"solid\": {}", self.solid.to_json()),
            false => String::new(),
        };
        format!(
            "{{\n  \"name\": \"{}\",\n  \"cell_size_m\": {:?},\n  \"moves\": {moves},\n  \
             \"wrap\": {}{origin},\n  \"rows\": {}{floor}{solid}\n}}\n",
            self.name,
            self.cell_size_m,
            self.wrap,
            array(rows),
        )
    }
}

/// Formats rows as an array with one line per row.
fn array(rows: impl Iterator<Item = String>) -> String {
    let rows: Vec<String> = rows.map(|row| format!("    \"{row}\"")).collect();
    format!("[\n{}\n  ]", rows.join(",\n"))
}

fn too_large(origin: &str) -> WorldError {
    let help = "split the world or make it smaller";
    Source::error(origin, None, "the world file is larger than 64 MiB", help)
}

fn decode<'a>(text: &'a [u8], origin: &str) -> Result<&'a str, WorldError> {
    std::str::from_utf8(text).map_err(|error| {
        let at = error.valid_up_to();
        let shown = String::from_utf8_lossy(&text[..at]);
        let source = Source {
            origin,
            text: &shown,
        };
        source.fault(at, "the file is not UTF-8 text", "save the file as UTF-8")
    })
}

fn read_maze(source: Source<'_>) -> Result<Maze, WorldError> {
    let document = Document::parse(source)?;
    let name = read_name(source, document.value("name"))?;
    let cell_size_m = read_cell_size(source, document.value("cell_size_m"))?;
    let moves = read_moves(source, document.value("moves"))?;
    let wrap = read_wrap(source, document.value("wrap"))?;
    let origin = Origin::read(source, document.value("origin"))?;
    let raw_rows = document
        .value("rows")
        .ok_or_else(|| missing_key(source, "rows"))?;
    let mut rows = Rows::parse(source, raw_rows)?;
    check_start_and_goal(source, &rows)?;
    let walls = std::mem::take(&mut rows.walls).into();
    let mut maze = Maze {
        name,
        cell_size_m,
        moves,
        wrap,
        origin,
        width: rows.width(),
        height: rows.height(),
        solid: Maze::solid_cells(&walls, rows.width(), cell_size_m),
        obstructed: None,
        walls,
        open: None,
        start: rows.starts.first().copied(),
        goals: std::mem::take(&mut rows.goals),
        floor: None,
        cache: Default::default(),
    };
    if let Some(raw) = document.value("floor") {
        maze.floor = floor::read(source, raw, &maze)?;
    }
    if let Some(raw) = document.value("solid") {
        maze.solid = Arc::new(Solid::read(source, raw, &maze)?);
        maze.find_open_moves();
    }
    if !wrap {
        check_border(source, &maze, &rows)?;
    }
    check_reachable(source, &maze, &rows)?;
    Ok(maze)
}

fn read_name(source: Source<'_>, raw: Option<&str>) -> Result<String, WorldError> {
    let Some(raw) = raw else {
        return name_from_origin(source);
    };
    if kind(raw) != Some("a string") {
        return Err(wrong_type(source, "name", raw, "a string"));
    }
    let name: String = serde_json::from_str(raw).unwrap_or_else(|_| raw.to_owned());
    if name::is_valid(&name) {
        return Ok(name);
    }
    Err(source.fault(
        source.start_of(raw),
        format!("{} cannot be the name of a world", quoted(&name)),
        name::RULE,
    ))
}

fn name_from_origin(source: Source<'_>) -> Result<String, WorldError> {
    let stem = Path::new(source.origin)
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned())
        .unwrap_or_default();
    if name::is_valid(&stem) {
        return Ok(stem);
    }
    let at = source.text.find('{').unwrap_or(0);
    Err(source.fault(
        at,
        format!(
            "the world has no name, and the file's name {} cannot be one",
            quoted(&stem)
        ),
        format!("add \"name\": \"{}\"", name::repaired(&stem)),
    ))
}

fn read_cell_size(source: Source<'_>, raw: Option<&str>) -> Result<f64, WorldError> {
    let Some(raw) = raw else {
        return Ok(1.0);
    };
    if kind(raw) != Some("a number") {
        return Err(wrong_type(source, "cell_size_m", raw, "a number"));
    }
    // A number that is too large for the type counts as infinite.
    let size = serde_json::from_str(raw).unwrap_or(f64::INFINITY);
    if CELL_SIZE_M.contains(&size) {
        return Ok(size);
    }
    let (low, high) = (CELL_SIZE_M.start(), CELL_SIZE_M.end());
    Err(source.fault(
        source.start_of(raw),
        format!(
            "`cell_size_m` is {}, but must be from {low} to {high}",
            quoted(raw)
        ),
        "`cell_size_m` is the edge of a cell in metres; leave it out for 1.0",
    ))
}

fn read_moves(source: Source<'_>, raw: Option<&str>) -> Result<Moves, WorldError> {
    let Some(raw) = raw else {
        return Ok(Moves::default());
    };
    if kind(raw) != Some("a number") {
        return Err(wrong_type(source, "moves", raw, "4 or 8"));
    }
    match serde_json::from_str(raw) {
        Ok(4.0) => Ok(Moves::Four),
        Ok(8.0) => Ok(Moves::Eight),
        _ => Err(source.fault(
            source.start_of(raw),
            format!("`moves` is {}, expected 4 or 8", quoted(raw)),
            "4 means north, east, south and west; 8 adds the diagonals",
        )),
    }
}

fn read_wrap(source: Source<'_>, raw: Option<&str>) -> Result<bool, WorldError> {
    match raw {
        None | Some("false") => Ok(false),
        Some("true") => Ok(true),
        Some(raw) => Err(wrong_type(source, "wrap", raw, "true or false")),
    }
}
