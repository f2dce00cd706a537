//! Cells that a sensor cannot tell apart.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Sensor;
use crate::world::{Cell, Maze, Paths};
use xcs::{Action, Percept};

/// Free cells, two or more and none of them a goal, that give the same percept.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Alike {
    /// What the robot perceives in each of the cells.
    pub percept: Percept,
    /// The cells in reading order.
    pub cells: Vec<Cell>,
    /// Is there an action that lies on a shortest path from every one of the cells? If not, no
    /// policy over this percept is optimal from everywhere.
    pub share_a_best_action: bool,
}

/// The groups of cells that look alike, ordered by percept.
pub fn alike(sensor: Sensor, maze: &Maze) -> Vec<Alike> {
    let paths = Paths::new(maze);
    let mut groups: BTreeMap<Percept, Vec<Cell>> = BTreeMap::new();
    for cell in maze.free_cells().filter(|&cell| !maze.is_goal(cell)) {
        let percept = sensor.perceive_at(maze, cell);
        groups.entry(percept).or_default().push(cell);
    }
    let is_best = |cell, action| paths.successor(maze, cell, action).is_some();
    groups
        .into_iter()
        .filter(|(_, cells)| cells.len() > 1)
        .map(|(percept, cells)| Alike {
            percept,
            share_a_best_action: Action::all(maze.action_count())
                .any(|action| cells.iter().all(|&cell| is_best(cell, action))),
            cells,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn groups(sensor: Sensor, rows: [&str; 3]) -> Vec<Alike> {
        let text = format!(r#"{{"rows": {rows:?}}}"#);
        alike(
            sensor,
            &Maze::from_json(text.as_bytes(), "test.json").unwrap(),
        )
    }

    const CORRIDOR: [&str; 3] = ["#########", "#...G...#", "#########"];

    #[test]
    fn cells_left_and_right_of_the_goal_look_alike_and_share_no_best_action() {
        let groups = groups(Sensor::Neighbours, CORRIDOR);
        let cell = |col| Cell { col, row: 1 };
        let found: Vec<_> = groups
            .iter()
            .map(|group| (group.cells.clone(), group.share_a_best_action))
            .collect();
        assert_eq!(found, [(vec![cell(2), cell(6)], false)]);
    }

    #[test]
    fn no_two_cells_have_the_same_position() {
        assert_eq!(groups(Sensor::Position, CORRIDOR), []);
    }

    #[test]
    fn cells_that_look_alike_can_share_a_best_action() {
        let groups = groups(Sensor::Neighbours, ["########", "#S....G#", "########"]);
        assert_eq!(groups.len(), 1, "{groups:?}");
        assert!(groups[0].share_a_best_action, "{groups:?}");
    }
}
