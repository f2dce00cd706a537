//! Reads, checks and writes world files.

use std::io;
use std::path::Path;
use std::sync::Arc;

use super::checks::{check_border, check_reachable, check_start_and_goal};
use super::direction::Moves;
use super::error::{Fault, WorldError, quoted};
use super::floor;
use super::keys::Keys;
use super::maze::Maze;
use super::name;
use super::near;
use super::origin::Origin;
use super::rows::Rows;
use super::solid::Solid;
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
    /// * a floor that does not fit the rows
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
        read_maze(text, origin).map_err(|fault| fault.in_file(origin))
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
    Fault::new("the world file is larger than 64 MiB", help).in_file(origin)
}

fn read_maze(text: &[u8], origin: &str) -> Result<Maze, Fault> {
    let text = std::str::from_utf8(text)
        .map_err(|_| Fault::new("the file is not UTF-8 text", "save the file as UTF-8"))?;
    if origin.ends_with(".toml") && !text.trim_start().starts_with('{') {
        let help = "run a study file with `xcscr study run FILE`, and give a settings file after `--config`";
        return Err(Fault::new("a world is a JSON file", help));
    }
    let keys = Keys::parse(text)?;
    let name = checked_name(keys.name, origin)?;
    let cell_size_m = checked_cell_size(keys.cell_size_m)?;
    let moves = checked_moves(keys.moves)?;
    keys.origin.check()?;
    let rows = Rows::parse(&keys.rows.0)?;
    check_start_and_goal(&rows)?;
    let walls = rows.walls.into();
    let mut maze = Maze {
        name,
        cell_size_m,
        moves,
        wrap: keys.wrap,
        origin: keys.origin,
        width: rows.width,
        height: rows.height,
        solid: Maze::solid_cells(&walls, rows.width, cell_size_m),
        obstructed: None,
        walls,
        open: None,
        start: rows.starts.first().copied(),
        goals: rows.goals,
        floor: None,
        cache: Default::default(),
    };
    if let Some(floor) = &keys.floor {
        maze.floor = floor::read(&floor.0, &maze)?;
    }
    if let Some(solid) = keys.solid {
        maze.solid = Arc::new(Solid::of_keys(solid, &maze)?);
        maze.find_open_moves();
    }
    if !maze.wrap {
        check_border(&maze)?;
    }
    check_reachable(&maze)?;
    Ok(maze)
}

/// Returns the name of a world, by default the stem of its file's name.
fn checked_name(given: Option<String>, origin: &str) -> Result<String, Fault> {
    let stem = || {
        Path::new(origin)
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
    };
    let name = given.clone().unwrap_or_else(|| stem().into_owned());
    match (name::is_valid(&name), given) {
        (true, _) => Ok(name),
        (false, Some(name)) => {
            let title = format!("{} cannot be the name of a world", quoted(&name));
            Err(Fault::new(title, name::RULE))
        }
        (false, None) => Err(Fault::new(
            format!(
                "the world has no name, and the file's name {} cannot be one",
                quoted(&name)
            ),
            format!("add \"name\": \"{}\"", name::repaired(&name)),
        )),
    }
}

fn checked_cell_size(size_m: f64) -> Result<f64, Fault> {
    if CELL_SIZE_M.contains(&size_m) {
        return Ok(size_m);
    }
    let (low, high) = (CELL_SIZE_M.start(), CELL_SIZE_M.end());
    Err(Fault::new(
        format!("`cell_size_m` is {size_m:?}, but must be from {low} to {high}"),
        "`cell_size_m` is the edge of a cell in metres; leave it out for 1.0",
    ))
}

fn checked_moves(moves: f64) -> Result<Moves, Fault> {
    match moves {
        4.0 => Ok(Moves::Four),
        8.0 => Ok(Moves::Eight),
        _ => Err(Fault::new(
            format!("`moves` is {moves}, expected 4 or 8"),
            "4 means north, east, south and west; 8 adds the diagonals",
        )),
    }
}
