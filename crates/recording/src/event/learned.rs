//! `/values`: what the robot has learned about each cell.

use std::collections::BTreeSet;

use foxglove::Decode;
use foxglove::messages::{
    Grid, PackedElementField, Pose, Vector2, packed_element_field::NumericType,
};

use xcs::{Action, ByAction};
use xcscr_learner::episode::{PolicyMap, greedy_path};
use xcscr_robot::world::{Cell, Maze};

/// The bytes of a cell on the topic before the shares of its actions: three numbers of four bytes, and the best actions.
const HEAD: usize = 13;
/// The most bytes of a message beside the data of its cells.
const MOST_BESIDE: usize = 4096;
/// The share of an action without a value.
const UNKNOWN: i8 = i8::MIN;
/// The least rank and nearness of a cell that has them.
const LEAST: f32 = 0.1;

/// The learned policy. In a [very large](Maze::is_too_large) maze, it has the cells of the greedy path
/// only.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Learned {
    /// The cells with known action values, in reading order.
    pub cells: Vec<LearnedCell>,
}

/// What the robot has learned about a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnedCell {
    /// The cell.
    pub cell: Cell,
    /// The greatest action value.
    pub value: f32,
    /// The rank of the value among all cells, from 0.1 (the least) to 1 (the greatest).
    pub rank: f32,
    /// The nearness to the goal along the policy, from 0.1 (the farthest cell) to 1 (one step); 0 if
    /// the policy leads to no goal.
    pub nearness: f32,
    /// The best actions, as bits.
    pub best: u8,
    /// By action: the value in percent of the greatest magnitude of all values, rounded away from 0; `None` without a
    /// value.
    pub shares: ByAction<Option<i8>>,
}

/// Returns the greatest magnitude of an action value.
fn greatest_magnitude(policy: &PolicyMap) -> f64 {
    let values = policy
        .cells()
        .flat_map(|(_, values)| values.as_slice().iter().flatten());
    values.fold(0.0, |greatest, value| value.abs().max(greatest))
}

impl Learned {
    /// Evaluates a policy.
    pub fn of(policy: &PolicyMap, maze: &Maze) -> Self {
        let share = |share: f64| LEAST + (1.0 - LEAST) * share as f32;
        let greatest = greatest_magnitude(policy).max(f64::MIN_POSITIVE);
        let percent = |value: f64| (100.0 * value.abs() / greatest).ceil().copysign(value) as i8;
        let figures = policy.ranks().into_iter().zip(policy.nearness(maze));
        let cells = policy.cells().zip(figures);
        let cells = cells.filter_map(|((cell, values), (rank, near))| {
            let best = values.best_actions();
            Some(LearnedCell {
                cell: *cell,
                value: values.greatest()? as f32,
                rank: share(rank?),
                nearness: near.map_or(0.0, share),
                best: best.fold(0, |bits, action| bits | 1 << action.index()),
                shares: std::array::from_fn(|action| {
                    values
                        .as_slice()
                        .get(action)
                        .copied()
                        .flatten()
                        .map(percent)
                }),
            })
        });
        Self {
            cells: cells.collect(),
        }
    }

    /// Returns the number of cells whose best actions differ.
    pub fn changes_from(&self, other: &Self) -> usize {
        let set = |of: &Self| -> BTreeSet<(u16, u16, u8)> {
            let cells = of.cells.iter();
            cells
                .map(|at| (at.cell.row, at.cell.col, at.best))
                .collect()
        };
        let (new, old) = (set(self), set(other));
        new.difference(&old)
            .count()
            .max(old.difference(&new).count())
    }

    /// Returns the cells of the [greedy path](greedy_path) from `start`, with ties broken by the first best action.
    pub fn greedy_path(&self, maze: &Maze, start: Cell) -> Vec<Cell> {
        greedy_path(start, |cell| self.ahead(maze, cell))
    }

    fn ahead(&self, maze: &Maze, cell: Cell) -> Option<Cell> {
        let key = |at: &LearnedCell| (at.cell.row, at.cell.col);
        let here = self.cells.binary_search_by_key(&(cell.row, cell.col), key);
        let best = self.cells[here.ok()?].best;
        let action =
            Action::all(maze.action_count()).find(|action| best >> action.index() & 1 == 1);
        maze.step(cell, maze.direction(action?)?)
    }

    /// Returns the message: a grid with a cell for each cell of the maze, the southern row first. It is
    /// empty in a very large maze.
    pub fn grid(&self, maze: &Maze, frame: &str, pose: Pose) -> Grid {
        let columns = if maze.is_too_large() { 0 } else { maze.width() };
        let stride = HEAD + maze.action_count();
        let mut data = vec![0; usize::from(columns) * usize::from(maze.height()) * stride];
        for cell in data.chunks_exact_mut(stride) {
            cell[..4].copy_from_slice(&f32::NAN.to_le_bytes());
            cell[HEAD..].fill(UNKNOWN as u8);
        }
        for known in self.cells.iter().filter(|_| columns > 0) {
            let row = usize::from(maze.height() - 1 - known.cell.row);
            let at = (row * usize::from(columns) + usize::from(known.cell.col)) * stride;
            let numbers = [known.value, known.rank, known.nearness].map(f32::to_le_bytes);
            let cell = &mut data[at..at + stride];
            cell[..12].copy_from_slice(&numbers.concat());
            cell[12] = known.best;
            for (to, share) in cell[HEAD..].iter_mut().zip(known.shares) {
                *to = share.unwrap_or(UNKNOWN) as u8;
            }
        }
        let field = |name: &str, offset: usize, kind: NumericType| PackedElementField {
            name: name.to_owned(),
            offset: offset as u32,
            r#type: kind as i32,
        };
        let mut fields = vec![
            field("value", 0, NumericType::Float32),
            field("rank", 4, NumericType::Float32),
            field("nearness", 8, NumericType::Float32),
            field("best_actions", 12, NumericType::Uint8),
        ];
        fields.extend(Action::all(maze.action_count()).map(|action| {
            let name = maze.action_name(action).replace('-', "_");
            field(&name, HEAD + action.index(), NumericType::Int8)
        }));
        let unit = maze.cell_size_m();
        Grid {
            timestamp: None,
            frame_id: frame.to_owned(),
            pose: Some(pose),
            column_count: columns.into(),
            cell_size: Some(Vector2 { x: unit, y: unit }),
            row_stride: u32::from(columns) * stride as u32,
            cell_stride: stride as u32,
            fields,
            data: data.into(),
        }
    }

    /// Reads a message.
    ///
    /// # Errors
    /// What is wrong with the message, as text.
    pub fn of_message(data: &[u8], maze: &Maze) -> Result<Self, String> {
        let stride = HEAD + maze.action_count();
        let most = usize::from(maze.width()) * usize::from(maze.height()) * stride + MOST_BESIDE;
        // Empty fields take many times their bytes in memory.
        if data.len() > most {
            return Err("it is larger than the policy of its maze".to_owned());
        }
        let grid = Grid::decode(data).map_err(|fault| fault.to_string())?;
        Self::of_grid(&grid, maze)
    }

    fn of_grid(grid: &Grid, maze: &Maze) -> Result<Self, String> {
        let (columns, stride) = (usize::from(maze.width()), HEAD + maze.action_count());
        let is_whole = grid.data.len() == columns * usize::from(maze.height()) * stride;
        if grid.data.is_empty() {
            return Ok(Self::default());
        }
        if grid.cell_stride as usize != stride || !is_whole {
            return Err("the grid is not that of the maze".to_owned());
        }
        let number = |cell: &[u8], at: usize| {
            let bytes = cell[at..at + 4].try_into().expect("four bytes");
            f32::from_le_bytes(bytes)
        };
        let share = |cell: &[u8], action: usize| {
            let share = cell.get(HEAD + action).map(|&byte| byte as i8);
            share.filter(|&share| share != UNKNOWN)
        };
        let rows = grid.data.chunks_exact(columns * stride).rev().enumerate();
        let cells = rows.flat_map(|(row, cells)| {
            let cells = cells.chunks_exact(stride).enumerate();
            cells.map(move |(col, cell)| LearnedCell {
                cell: Cell {
                    col: col as u16,
                    row: row as u16,
                },
                value: number(cell, 0),
                rank: number(cell, 4),
                nearness: number(cell, 8),
                best: cell[12],
                shares: std::array::from_fn(|action| share(cell, action)),
            })
        });
        Ok(Self {
            cells: cells.filter(|cell| cell.best != 0).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maze() -> Maze {
        let rows = br######"{ "rows": ["#####", "#S.G#", "#...#", "#####"] }"######;
        Maze::from_json(rows, "rows").unwrap()
    }

    fn learned(cells: &[(u16, u16, u8)]) -> Learned {
        let cells = cells.iter().map(|&(col, row, best)| LearnedCell {
            cell: Cell { col, row },
            value: f32::from(col),
            rank: 0.5,
            nearness: 0.25,
            best,
            shares: [Some(-3), Some(100), None, Some(0), None, None, None, None],
        });
        Learned {
            cells: cells.collect(),
        }
    }

    #[test]
    fn a_grid_is_read_as_it_was_written_and_another_size_is_refused() {
        let (maze, learned) = (maze(), learned(&[(1, 1, 2), (2, 1, 3), (1, 2, 1)]));
        let mut grid = learned.grid(&maze, "grid", Pose::default());
        assert_eq!(Learned::of_grid(&grid, &maze).unwrap(), learned);
        // The southern row comes first: row 2 of four rows from the north is the second one.
        let stride = HEAD + 4;
        assert_eq!(grid.data[(5 + 1) * stride + 12], 1);
        grid.data = grid.data.slice(stride..);
        assert!(Learned::of_grid(&grid, &maze).is_err());
    }

    #[test]
    fn a_greedy_path_ends_at_a_goal_and_where_it_would_repeat() {
        // East is action 1, west is action 3.
        let to_goal = learned(&[(1, 1, 2), (2, 1, 2)]);
        let path = to_goal.greedy_path(&maze(), Cell { col: 1, row: 1 });
        assert_eq!(path.len(), 3);
        let around = learned(&[(1, 1, 2), (2, 1, 8)]);
        let path = around.greedy_path(&maze(), Cell { col: 1, row: 1 });
        assert_eq!(path.len(), 2);
    }

    #[test]
    fn changes_are_cells_with_other_best_actions() {
        let before = learned(&[(1, 1, 2), (2, 1, 2)]);
        assert_eq!(before.changes_from(&before), 0);
        let after = learned(&[(1, 1, 2), (2, 1, 3), (1, 2, 1)]);
        assert_eq!(after.changes_from(&before), 2);
    }
}
