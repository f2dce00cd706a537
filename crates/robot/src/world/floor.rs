//! The floor: the friction of each cell, where a world file specifies it.

use super::error::{Fault, quoted};
use super::maze::{Cell, Floor, Maze};

/// Describes the letters of a floor, for help lines.
const LETTERS: &str =
    "the letters of a floor are `#` wall, `.` usual floor, and `1` to `9`, its friction in tenths";

/// Reads the floor of a world whose rows are already read.
pub(super) fn read(texts: &[String], maze: &Maze) -> Result<Floor, Fault> {
    let wanted = usize::from(maze.height());
    if texts.len() != wanted {
        let title = format!("the floor has {} rows, the world {wanted}", texts.len());
        let help = "give the floor a row for each of `rows`, or leave `floor` out";
        return Err(Fault::new(title, help));
    }
    let mut tenths = Vec::with_capacity(maze.walls.len());
    for (row, text) in (0..maze.height()).zip(texts) {
        let (found, wanted) = (text.chars().count(), usize::from(maze.width()));
        if found != wanted {
            let title = format!("row {} of the floor has {found} cells", row + 1);
            let help = format!("each row of `rows` has {wanted}; give the floor as many");
            return Err(Fault::new(title, help));
        }
        for (col, letter) in (0..maze.width()).zip(text.chars()) {
            let cell = Cell { col, row };
            let tenth = tenths_of(letter, maze.is_wall(cell));
            tenths.push(tenth.map_err(|[title, help]| Fault::at_cell(cell, title, help))?);
        }
    }
    let is_usual = tenths.iter().all(|&tenth| tenth == 0);
    Ok((!is_usual).then(|| tenths.into()))
}

/// Returns the friction in tenths that a letter means. Errors are a title and a help line.
fn tenths_of(letter: char, is_wall: bool) -> Result<u8, [String; 2]> {
    let fault = |title: String, help: &str| Err([title, help.to_owned()]);
    match (letter, is_wall) {
        ('.', _) | ('#', true) => Ok(0),
        ('1'..='9', false) => Ok(letter as u8 - b'0'),
        ('#', false) => fault(
            "the floor has a wall where `rows` has none".to_owned(),
            "write `.` for the usual floor",
        ),
        ('1'..='9', true) => fault(
            format!("the floor has friction `{letter}` below a wall"),
            "write `#` or `.` there, or free the cell in `rows`",
        ),
        ('0', _) => fault(
            "a floor without friction cannot be driven on".to_owned(),
            "the smallest value is `1`, a friction of 0.1",
        ),
        _ => {
            let letter = quoted(&letter.to_string());
            fault(
                format!("the floor has the unknown letter {letter}"),
                LETTERS,
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::WorldError;

    const ROWS: [&str; 3] = ["#####", "#S.G#", "#####"];

    fn maze(floor: [&str; 3]) -> Result<Maze, WorldError> {
        let text = format!(r#"{{ "rows": {ROWS:?}, "floor": {floor:?} }}"#);
        Maze::from_json(text.as_bytes(), "wet.json")
    }

    #[test]
    fn a_digit_is_friction_in_tenths_and_any_other_floor_is_usual() {
        let maze = maze(["#####", "#.3.#", "....."]).unwrap();
        let friction = |col, row| maze.friction(Cell { col, row });
        assert_eq!(friction(2, 1), Some(0.3));
        assert_eq!([friction(1, 1), friction(0, 0), friction(9, 9)], [None; 3]);
        assert_eq!(maze.floor_rows().unwrap(), ["#####", "#.3.#", "#####"]);
    }

    #[test]
    fn a_floor_that_is_usual_everywhere_is_none() {
        let text = format!(r#"{{ "rows": {ROWS:?} }}"#);
        let plain = Maze::from_json(text.as_bytes(), "wet.json").unwrap();
        let usual = maze(["#####", "#...#", "#####"]).unwrap();
        assert_eq!(usual, plain);
        assert!(!usual.to_json().contains("floor"));
    }

    #[test]
    fn a_maze_can_be_given_a_floor_of_one_friction() {
        let maze = maze(["#####", "#.3.#", "#####"]).unwrap();
        let wet = maze.with_friction(5).floor_rows().unwrap();
        assert_eq!(wet, ["#####", "#555#", "#####"]);
        assert!(!maze.with_friction(0).has_floor());
    }

    #[test]
    fn a_floor_is_written_and_read_again() {
        let wet = maze(["#####", "#29.#", "#####"]).unwrap();
        let again = Maze::from_json(wet.to_json().as_bytes(), "again.json").unwrap();
        assert_eq!(again, wet);
    }
}
