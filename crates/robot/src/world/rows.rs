//! Parses the rows of a world into walls, start and goals.

use super::error::{Fault, quoted};
use super::maze::Cell;

/// The largest number of columns, and of rows. At this size, the first episode of training on the
/// grid takes up to five seconds and 200 MB.
pub const MAX_SIDE: usize = 4096;

/// The cells of a world. All rows have the same width.
pub(super) struct Rows {
    pub width: u16,
    pub height: u16,
    pub walls: Vec<bool>,
    pub starts: Vec<Cell>,
    pub goals: Vec<Cell>,
}

impl Rows {
    /// Reads at most [`MAX_SIDE`] rows. Refuses other sizes and letters.
    pub fn parse(texts: &[String]) -> Result<Self, Fault> {
        let Some(first) = texts.first() else {
            let help = "give at least three rows, such as \"###\", \"#G#\", \"###\"";
            return Err(Fault::new("the world has no rows", help));
        };
        let width = first.chars().count();
        if width > MAX_SIDE {
            return Err(Fault::new(
                format!("row 1 has {width} cells, at most {MAX_SIDE} are possible"),
                format!("a world has at most {MAX_SIDE} columns and {MAX_SIDE} rows"),
            ));
        }
        let mut rows = Self {
            width: width as u16,
            height: texts.len() as u16,
            walls: Vec::with_capacity(width * texts.len()),
            starts: Vec::new(),
            goals: Vec::new(),
        };
        for (row, text) in (0..rows.height).zip(texts) {
            check_width(row, text, width)?;
            for (col, letter) in (0..rows.width).zip(text.chars()) {
                rows.add(Cell { col, row }, letter)?;
            }
        }
        Ok(rows)
    }

    fn add(&mut self, cell: Cell, letter: char) -> Result<(), Fault> {
        self.walls.push(letter == '#');
        match letter {
            '#' | '.' => {}
            'S' => self.starts.push(cell),
            'G' => self.goals.push(cell),
            _ => {
                let letter = quoted(&letter.to_string());
                let help = "the letters are `#` wall, `.` free, `S` start, `G` goal";
                return Err(Fault::at_cell(
                    cell,
                    format!("the letter {letter} is unknown"),
                    help,
                ));
            }
        }
        Ok(())
    }
}

fn check_width(row: u16, text: &str, expected: usize) -> Result<(), Fault> {
    let (number, found) = (u32::from(row) + 1, text.chars().count());
    if found == 0 {
        let help = "a row is a string of `#`, `.`, `S` and `G`; remove the empty one";
        return Err(Fault::new(format!("row {number} is empty"), help));
    }
    let help = match expected.checked_sub(found) {
        Some(0) => return Ok(()),
        Some(more) => format!("add {} to row {number}", cells(more)),
        None => format!("remove {} from row {number}", cells(found - expected)),
    };
    let title = format!("row {number} has {}, expected {expected}", cells(found));
    Err(Fault::new(title, help))
}

fn cells(count: usize) -> String {
    match count {
        1 => "1 cell".to_owned(),
        _ => format!("{count} cells"),
    }
}
