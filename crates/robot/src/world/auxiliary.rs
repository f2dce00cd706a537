//! Auxiliary rewards: cells that give a reward once per episode.

use super::error::WorldError;
use super::json::{kind, wrong_type};
use super::maze::{Auxiliary, Cell, Maze};
use super::rows::Rows;
use super::source::{Source, quoted};

/// The largest auxiliary reward.
const MOST: f64 = 1e6;

/// Reads the reward of the cells marked `*`.
pub(super) fn read(
    source: Source<'_>,
    raw: Option<&str>,
    rows: &Rows<'_>,
) -> Result<Option<Auxiliary>, WorldError> {
    match (rows.rewarding.first(), raw) {
        (None, None) => Ok(None),
        (Some(&cell), None) => Err(source.fault(
            rows.start_of(cell),
            "cells are marked `*`, but the world has no `reward`",
            "add for example `\"reward\": 100`, or write `.` for a cell without a reward",
        )),
        (None, Some(raw)) => Err(source.fault(
            source.start_of(raw),
            "`reward` is set, but no cell is marked `*`",
            "mark the rewarding cells with `*` in `rows`, or leave `reward` out",
        )),
        (Some(_), Some(raw)) => Ok(Some(Auxiliary {
            cells: rows.rewarding.clone(),
            reward: read_reward(source, raw)?,
        })),
    }
}

fn read_reward(source: Source<'_>, raw: &str) -> Result<f64, WorldError> {
    if kind(raw) != Some("a number") {
        return Err(wrong_type(source, "reward", raw, "a number"));
    }
    // A number that is too large for the type counts as infinite.
    let reward = serde_json::from_str(raw).unwrap_or(f64::INFINITY);
    if reward > 0.0 && reward <= MOST {
        return Ok(reward);
    }
    Err(source.fault(
        source.start_of(raw),
        format!(
            "`reward` is {}, but must be above 0 and at most {MOST}",
            quoted(raw)
        ),
        "`reward` is the reward of each cell marked `*`; the setting `reward.goal` (1000) is the reward of a goal",
    ))
}

/// Returns the rewarding cells that no episode can enter: every path from a start ends at a goal
/// first.
pub(super) fn out_of_reach(maze: &Maze) -> Vec<Cell> {
    let paying = maze.rewarding_cells();
    if paying.is_empty() {
        return Vec::new();
    }
    let mut entered = vec![false; usize::from(maze.width()) * usize::from(maze.height())];
    let mut open: Vec<Cell> = maze.starts().collect();
    while let Some(cell) = open.pop() {
        let around = maze.moves().directions().iter();
        for next in around.filter_map(|&along| maze.step(cell, along)) {
            if !maze.is_goal(next) && !std::mem::replace(&mut entered[maze.index(next)], true) {
                open.push(next);
            }
        }
    }
    let missed = paying.iter().filter(|&&cell| !entered[maze.index(cell)]);
    missed.copied().collect()
}

#[cfg(test)]
mod tests {
    use super::out_of_reach;
    use crate::world::{Cell, Maze};

    fn maze(rows: [&str; 3], more: &str) -> Result<Maze, String> {
        let text = format!(r#"{{ "rows": {rows:?}{more} }}"#);
        Maze::from_json(text.as_bytes(), "paid.json").map_err(|error| error.to_string())
    }

    const PAID: [&str; 3] = ["######", "#S*.G#", "######"];
    const UNPAID: [&str; 3] = ["######", "#S..G#", "######"];

    #[test]
    fn only_marked_cells_have_a_reward() {
        let maze = maze(PAID, r#", "reward": 2.5"#).unwrap();
        let pay = |col| maze.auxiliary_reward(Cell { col, row: 1 });
        assert_eq!([1, 2, 3, 4].map(pay), [None, Some(2.5), None, None]);
        let again = Maze::from_json(maze.to_json().as_bytes(), "again.json").unwrap();
        assert_eq!(again, maze);
    }

    #[test]
    fn rewarding_cells_are_out_of_reach_behind_walls_and_goals() {
        let cell = |col| Cell { col, row: 1 };
        let reward = r#", "reward": 1"#;
        for (row, cells) in [
            ("#S*.G#", vec![]),
            ("#SG*.#", vec![cell(3)]),
            ("#SG#*#", vec![cell(4)]),
            // A robot that starts there gets no reward, and cannot come back.
            ("#.G*G#", vec![cell(3)]),
            ("#.G*.#", vec![]),
        ] {
            let maze = maze(["######", row, "######"], reward).unwrap();
            assert_eq!(out_of_reach(&maze), cells, "{row}");
        }
    }

    #[test]
    fn a_field_of_a_million_rewards_is_searched_once() {
        const SIDE: usize = 1024;
        let mut rows = vec!["#".to_owned() + &"*".repeat(SIDE - 2) + "#"; SIDE];
        (rows[0], rows[SIDE - 1]) = ("#".repeat(SIDE), "#".repeat(SIDE));
        rows[1].replace_range(1..4, "SG#");
        rows[2].replace_range(2..4, "*#");
        rows[3].replace_range(1..4, "###");
        let text = format!(r#"{{ "rows": {rows:?}, "reward": 1 }}"#);
        let maze = Maze::from_json(text.as_bytes(), "paid.json").unwrap();
        // Two cells, next to the start, are inside the walls.
        let within = 2;
        assert_eq!(
            out_of_reach(&maze).len(),
            maze.rewarding_cells().len() - within
        );
    }

    #[test]
    fn a_world_without_marked_cells_is_written_without_a_reward() {
        assert!(!maze(UNPAID, "").unwrap().to_json().contains("reward"));
    }

    #[test]
    fn marks_without_a_reward_and_a_reward_without_marks_are_refused() {
        for (rows, more, fault) in [
            (PAID, "", "the world has no `reward`"),
            (UNPAID, r#", "reward": 1"#, "no cell is marked `*`"),
            (PAID, r#", "reward": 0"#, "must be above 0"),
            (PAID, r#", "reward": 1e999"#, "must be above 0"),
            (PAID, r#", "reward": "much""#, "a number"),
        ] {
            let message = maze(rows, more).unwrap_err();
            assert!(message.contains(fault), "{more}: {message}");
        }
    }
}
