//! Parses the rows of a world file into walls, start and goals.

use super::document::Elements;
use super::error::WorldError;
use super::json::{kind, wrong_type};
use super::maze::Cell;
use super::source::{Source, quoted};

/// The largest number of columns, and of rows. At this size, the first episode of training on the
/// grid takes up to five seconds and 200 MB.
pub const MAX_SIDE: usize = 4096;

/// The cells of a world. All rows have the same width.
pub struct Rows<'a> {
    source: Source<'a>,
    /// The raw text of the array.
    pub raw: &'a str,
    /// The letters of each row; all of them are ASCII.
    rows: Vec<&'a str>,
    pub walls: Vec<bool>,
    pub starts: Vec<Cell>,
    pub goals: Vec<Cell>,
}

impl<'a> Rows<'a> {
    /// Reads the array of rows. Refuses wrong types, sizes and letters.
    pub fn parse(source: Source<'a>, raw: &'a str) -> Result<Self, WorldError> {
        if kind(raw) != Some("an array") {
            return Err(wrong_type(source, "rows", raw, "an array of strings"));
        }
        let elements: Elements<'a, MAX_SIDE> = serde_json::from_str(raw)
            .map_err(|_| wrong_type(source, "rows", raw, "an array of strings"))?;
        if elements.count > MAX_SIDE {
            let title = format!("the world has {} rows", elements.count);
            return Err(too_large(source, raw, title));
        }
        let mut rows = Self {
            source,
            raw,
            rows: Vec::with_capacity(elements.count),
            walls: Vec::new(),
            starts: Vec::new(),
            goals: Vec::new(),
        };
        elements.first.iter().try_for_each(|row| rows.add(row))?;
        if rows.rows.is_empty() {
            let help = "give at least three rows, such as \"###\", \"#G#\", \"###\"";
            return Err(source.fault(source.start_of(raw), "the world has no rows", help));
        }
        Ok(rows)
    }

    /// Returns the number of columns.
    pub fn width(&self) -> u16 {
        self.rows.first().map_or(0, |row| row.len() as u16)
    }

    /// Returns the number of rows.
    pub fn height(&self) -> u16 {
        self.rows.len() as u16
    }

    /// Returns the byte of a cell's letter in the text.
    pub fn start_of(&self, cell: Cell) -> usize {
        self.source.start_of(self.rows[usize::from(cell.row)]) + usize::from(cell.col)
    }

    fn add(&mut self, raw: &'a str) -> Result<(), WorldError> {
        let number = self.rows.len() + 1;
        let Some(letters) = raw.strip_prefix('"').and_then(|r| r.strip_suffix('"')) else {
            let key = format!("rows[{}]", number - 1);
            return Err(wrong_type(self.source, &key, raw, "a string"));
        };
        if letters.len() > MAX_SIDE && letters.chars().count() > MAX_SIDE {
            let title = format!("row {number} has {} cells", letters.chars().count());
            return Err(too_large(self.source, raw, title));
        }
        self.check_letters(letters)?;
        self.check_width(raw, letters)?;
        self.rows.push(letters);
        self.collect(letters);
        Ok(())
    }

    fn check_letters(&self, letters: &str) -> Result<(), WorldError> {
        let strange = |&(_, letter): &(usize, char)| !matches!(letter, '#' | '.' | 'S' | 'G');
        let Some((at, letter)) = letters.char_indices().find(strange) else {
            return Ok(());
        };
        let row = self.rows.len() + 1;
        let letter = quoted(&letter.to_string());
        Err(self.source.fault(
            self.source.start_of(letters) + at,
            format!("row {row} has the unknown letter {letter}"),
            "the letters are `#` wall, `.` free, `S` start, `G` goal",
        ))
    }

    fn check_width(&self, raw: &str, letters: &str) -> Result<(), WorldError> {
        let (number, found) = (self.rows.len() + 1, letters.len());
        if found == 0 {
            let help = "a row is a string of `#`, `.`, `S` and `G`; remove the empty one";
            let title = format!("row {number} is empty");
            return Err(self.source.fault(self.source.start_of(raw), title, help));
        }
        let Some(first) = self.rows.first().filter(|first| first.len() != found) else {
            return Ok(());
        };
        let expected = first.len();
        let help = match expected > found {
            true => format!("add {} to row {number}", cells(expected - found)),
            false => format!("remove {} from row {number}", cells(found - expected)),
        };
        let title = format!("row {number} has {}, expected {expected}", cells(found));
        Err(self
            .source
            .fault(self.source.start_of(letters), title, help))
    }

    fn collect(&mut self, letters: &str) {
        let row = self.height() - 1;
        for (col, letter) in letters.bytes().enumerate() {
            let cell = Cell {
                col: col as u16,
                row,
            };
            self.walls.push(letter == b'#');
            match letter {
                b'S' => self.starts.push(cell),
                b'G' => self.goals.push(cell),
                _ => {}
            }
        }
    }
}

fn too_large(source: Source<'_>, raw: &str, title: String) -> WorldError {
    source.fault(
        source.start_of(raw),
        format!("{title}, at most {MAX_SIDE} are possible"),
        format!("a world has at most {MAX_SIDE} columns and {MAX_SIDE} rows"),
    )
}

fn cells(count: usize) -> String {
    match count {
        1 => "1 cell".to_owned(),
        _ => format!("{count} cells"),
    }
}
