//! Checks of a world beyond the letters of its rows.

use super::error::Fault;
use super::maze::{Cell, Maze};
use super::paths::Paths;
use super::rows::Rows;

/// Requires at least one goal, and at most one start.
pub fn check_start_and_goal(rows: &Rows) -> Result<(), Fault> {
    if rows.goals.is_empty() {
        let help = "mark at least one cell with `G`";
        return Err(Fault::new("the world has no goal", help));
    }
    let [_, second, ..] = rows.starts[..] else {
        return Ok(());
    };
    let title = match rows.starts.len() {
        2 => "the world has two starts".to_owned(),
        count => format!("the world has {count} starts"),
    };
    let help = "keep one `S`; without any, every episode starts in a random free cell";
    Err(Fault::at_cell(second, title, help))
}

/// Requires that every cell of the border is a wall.
pub fn check_border(maze: &Maze) -> Result<(), Fault> {
    let on_border = |cell: &Cell| {
        cell.col == 0
            || cell.row == 0
            || cell.col + 1 == maze.width()
            || cell.row + 1 == maze.height()
    };
    match maze.free_cells().find(on_border) {
        None => Ok(()),
        Some(gap) => Err(Fault::at_cell(
            gap,
            "the border is open",
            "close the border with `#`, or join the edges with \"wrap\": true",
        )),
    }
}

/// Requires that an episode can start, and that every start can reach a goal.
pub fn check_reachable(maze: &Maze) -> Result<(), Fault> {
    let paths = Paths::new(maze);
    let mut starts = maze
        .free_cells()
        .filter(|&cell| {
            maze.start().is_none_or(|start| start == cell) && paths.distance(maze, cell) != Some(0)
        })
        .peekable();
    if starts.peek().is_none() {
        return Err(Fault::new(
            "the world has no cell to start in: all free cells are goals",
            "mark a start with `S`, or free a cell with `.`",
        ));
    }
    let Some(cell) = starts.find(|&cell| paths.distance(maze, cell).is_none()) else {
        return Ok(());
    };
    let (title, help) = match maze.start() {
        Some(_) => (
            "no goal can be reached from the start",
            "open a wall on the way, or move `S` or `G`",
        ),
        None => (
            "no goal can be reached from a free cell, and episodes start in any of them",
            "make the cell a wall, open a path, or set a fixed start `S`",
        ),
    };
    Err(Fault::at_cell(cell, title, help))
}
