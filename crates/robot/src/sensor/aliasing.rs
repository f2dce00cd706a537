//! Perceptual aliasing: cells that a sensor cannot distinguish.

use std::collections::HashMap;

use foldhash::fast::FixedState;
use serde::Serialize;

use super::Sensor;
use crate::world::{Cell, Maze, Paths};
use xcs::{Action, Percept};

/// Two or more free cells, none of them a goal, with the same percept (perceptually aliased).
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AliasedCells {
    /// The percept in each of the cells.
    pub percept: Percept,
    /// The cells in reading order.
    pub cells: Vec<Cell>,
    /// True if some action is on a shortest path from every one of the cells. If false, no policy
    /// over this percept is optimal from everywhere.
    pub share_a_best_action: bool,
    /// The actions that are on a shortest path from every one of the cells.
    #[serde(skip)]
    shared: Vec<Action>,
}

impl Sensor {
    /// Returns the groups of perceptually aliased cells, ordered by percept.
    pub fn aliased_cells(self, maze: &Maze) -> Vec<AliasedCells> {
        aliased_among(self, maze, &Paths::new(maze), maze.free_cells())
    }
}

/// Returns the groups of perceptually aliased cells among `cells`, which must be in reading order.
pub fn aliased_among(
    sensor: Sensor,
    maze: &Maze,
    paths: &Paths,
    cells: impl Iterator<Item = Cell>,
) -> Vec<AliasedCells> {
    if sensor.tells_all_apart() {
        return Vec::new();
    }
    let mut numbers: HashMap<Percept, usize, FixedState> = HashMap::default();
    let mut groups: Vec<AliasedCells> = Vec::new();
    // In a hall, most cells have the same percept as the previous one.
    let mut before: Option<(Percept, usize)> = None;
    for cell in cells.filter(|&cell| !maze.is_goal(cell)) {
        let percept = sensor.perceive_at(maze, cell);
        let known = before.filter(|(other, _)| *other == percept);
        let number = known.map_or_else(
            || *numbers.entry(percept).or_insert(groups.len()),
            |(_, number)| number,
        );
        before = Some((percept, number));
        if number == groups.len() {
            groups.push(AliasedCells::of(percept, maze.action_count()));
        }
        groups[number].add(cell, |action| paths.successor(maze, cell, action).is_some());
    }
    groups.retain(|group| group.cells.len() > 1);
    groups.sort_unstable_by_key(|group| group.percept);
    groups
}

impl AliasedCells {
    /// Creates a group without cells.
    fn of(percept: Percept, actions: usize) -> Self {
        Self {
            percept,
            cells: Vec::new(),
            shared: Action::all(actions).collect(),
            share_a_best_action: true,
        }
    }

    fn add(&mut self, cell: Cell, is_best: impl Fn(Action) -> bool) {
        self.cells.push(cell);
        self.shared.retain(|&action| is_best(action));
        self.share_a_best_action = !self.shared.is_empty();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn groups(sensor: Sensor, rows: [&str; 3]) -> Vec<AliasedCells> {
        let text = format!(r#"{{"rows": {rows:?}}}"#);
        sensor.aliased_cells(&Maze::from_json(text.as_bytes(), "test.json").unwrap())
    }

    const CORRIDOR: [&str; 3] = ["#########", "#...G...#", "#########"];

    #[test]
    fn cells_left_and_right_of_the_goal_are_aliased_and_share_no_best_action() {
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
    fn aliased_cells_can_share_a_best_action() {
        let groups = groups(Sensor::Neighbours, ["########", "#S....G#", "########"]);
        assert_eq!(groups.len(), 1, "{groups:?}");
        assert!(groups[0].share_a_best_action, "{groups:?}");
    }
}
