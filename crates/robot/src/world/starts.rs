//! The cells in which episodes can start, accessible by number.

use super::maze::{Cell, Maze};

/// The cells in which an episode can start, accessible by their numbers in reading order. Stores a
/// count for each row, so that large mazes need no list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Starts {
    /// For each row: the number of start cells up to the end of the row.
    through_row: Vec<usize>,
}

impl Starts {
    /// Counts the start cells row by row.
    pub fn new(maze: &Maze) -> Self {
        let mut through_row = vec![0; usize::from(maze.height())];
        for cell in maze.starts() {
            through_row[usize::from(cell.row)] += 1;
        }
        let mut sum = 0;
        for count in &mut through_row {
            sum += *count;
            *count = sum;
        }
        Self { through_row }
    }

    /// Returns the number of start cells; a checked maze has at least one.
    pub fn count(&self) -> usize {
        self.through_row.last().copied().unwrap_or(0)
    }

    /// Returns the start cell with this number, counted from 0; `None` beyond the last.
    pub fn nth(&self, maze: &Maze, number: usize) -> Option<Cell> {
        if maze.start().is_some() {
            return maze.start().filter(|_| number == 0);
        }
        let row = self
            .through_row
            .partition_point(|&through| through <= number);
        let before = row
            .checked_sub(1)
            .map_or(0, |above| self.through_row[above]);
        let row = u16::try_from(row).ok().filter(|&row| row < maze.height())?;
        let cells = (0..maze.width()).map(|col| Cell { col, row });
        let mut starts = cells.filter(|&cell| !maze.is_wall(cell) && !maze.is_goal(cell));
        starts.nth(number - before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_by_number_match_the_list() {
        let closed = ["#######", "#...G.#", "#######"];
        let fixed = ["#####", "#.SG#", "#####"];
        for (wrap, rows) in [(false, &closed[..]), (false, &fixed), (true, &["..", "G."])] {
            let text = format!(r#"{{"wrap": {wrap}, "rows": {rows:?}}}"#);
            let maze = Maze::from_json(text.as_bytes(), "m.json").unwrap();
            let listed = maze.start_cells();
            let starts = Starts::new(&maze);
            assert_eq!(starts.count(), listed.len());
            let found = (0..listed.len()).filter_map(|number| starts.nth(&maze, number));
            assert_eq!(found.collect::<Vec<Cell>>(), listed);
            assert_eq!(starts.nth(&maze, listed.len()), None);
        }
    }
}
