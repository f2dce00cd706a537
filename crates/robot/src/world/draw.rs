//! Draws a maze as text for a terminal.

use super::maze::{Cell, Maze};

impl Maze {
    /// Returns a drawing of the maze, two characters per cell and a line per row; walls are full
    /// blocks.
    ///
    /// `glyph` returns the character of a free cell, such as the arrow of a policy. Where it
    /// returns none, the content is drawn: `S` start, `G` goal, `~` unusual floor, `*` a reward.
    /// Other free cells are blank. They are dots where the edges join and no border shows where the
    /// maze ends.
    pub fn drawn(&self, glyph: impl Fn(Cell) -> Option<char>) -> String {
        let mut picture = String::new();
        for cell in self.cells() {
            if self.is_wall(cell) {
                picture.push_str("██");
            } else {
                picture.push(glyph(cell).unwrap_or_else(|| letter(self, cell)));
                picture.push(' ');
            }
            if cell.col + 1 == self.width() {
                picture.truncate(picture.trim_end_matches(' ').len());
                picture.push('\n');
            }
        }
        picture
    }
}

fn letter(maze: &Maze, cell: Cell) -> char {
    match () {
        () if maze.is_goal(cell) => 'G',
        () if maze.start() == Some(cell) => 'S',
        () if maze.friction(cell).is_some() => '~',
        () if maze.wraps() => '·',
        () => ' ',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maze(wrap: bool, rows: &[&str]) -> Maze {
        let text = format!(r#"{{"wrap": {wrap}, "rows": {rows:?}}}"#);
        Maze::from_json(text.as_bytes(), "test.json").unwrap()
    }

    #[test]
    fn walls_are_blocks_and_each_cell_is_two_columns_wide() {
        let maze = maze(false, &["#####", "#S.G#", "#####"]);
        let expected = "██████████\n██S   G ██\n██████████\n";
        assert_eq!(maze.drawn(|_| None), expected);
    }

    #[test]
    fn a_glyph_replaces_the_letter_of_a_cell_but_not_of_a_wall() {
        let maze = maze(false, &["#####", "#S.G#", "#####"]);
        let picture = maze.drawn(|cell| (!maze.is_goal(cell)).then_some('→'));
        assert_eq!(picture, "██████████\n██→ → G ██\n██████████\n");
    }

    #[test]
    fn free_cells_show_where_the_edges_join() {
        let maze = maze(true, &["..", ".G"]);
        assert_eq!(maze.drawn(|_| None), "· ·\n· G\n");
    }
}
