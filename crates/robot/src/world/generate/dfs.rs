//! Depth-first search with backtracking over the cells with odd coordinates.

use super::field::Field;
use xcs::random::Stream;

/// Carves passages until every odd cell is part of the maze.
pub fn carve(field: &mut Field, stream: &mut Stream) {
    field.set_wall(1, 1, false);
    let mut path = vec![(1, 1)];
    while let Some(&(col, row)) = path.last() {
        let open = unvisited(field, col, row);
        let Some(&(next_col, next_row)) = stream.choose(&open) else {
            path.pop();
            continue;
        };
        field.set_wall(col.midpoint(next_col), row.midpoint(next_row), false);
        field.set_wall(next_col, next_row, false);
        path.push((next_col, next_row));
    }
}

/// The odd cells around an odd cell that are still walls.
fn unvisited(field: &Field, col: u16, row: u16) -> Vec<(u16, u16)> {
    let last = field.last();
    let around = [
        (col, row.saturating_sub(2)),
        (col + 2, row),
        (col, row + 2),
        (col.saturating_sub(2), row),
    ];
    let inside = |&(col, row): &(u16, u16)| {
        (1..=last).contains(&col) && (1..=last).contains(&row) && field.is_wall(col, row)
    };
    around.into_iter().filter(inside).collect()
}
