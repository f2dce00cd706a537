//! An agent that follows learned knowledge without learning.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::Serialize;

use crate::agent::credit::credit_of_rules;
use crate::agent::knowledge::Knowledge;
use crate::agent::{Agent, Choice, DecisionSource, EndCredit, Explorer, StepCredit, Transition};
use xcs::{Action, Condition, Percept, PredictionArray};
use xcscr_robot::arena::Outcome;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::{Cell, Maze};

/// A frozen method: it acts on its knowledge and changes nothing.
#[derive(Debug, Clone, Serialize)]
pub struct Frozen {
    knowledge: Knowledge,
    actions: usize,
    step_threshold: u32,
    /// `None` if the agent always takes the best action.
    #[serde(skip)]
    detours: Option<Detours>,
}

/// The number of visits after which a cell comes after others. A collision on the way to a cell
/// counts as so many visits.
const VISITS: u32 = 2;

/// Other ways around moves that are blocked. A move to a cell that was visited twice in this episode,
/// or to which a collision barred the way, comes after all others. So a robot in front of a box
/// neither repeats the move nor turns back and forth for ever. All this begins with the first sign of
/// something that is not in the map: a move that only the percept shows as closed, or a collision.
/// Before that, the best action is taken.
#[derive(Debug, Clone)]
struct Detours {
    maze: Maze,
    /// The number of bits of the percept for each action. Its second bit is set, and its first is
    /// not, if the percept shows that the move is closed. 0 if the percept shows no moves.
    bits: usize,
    /// The numbers of bits that show column and row. They are the last ones of the percept.
    place_bits: [usize; 2],
    /// True if something that is not in the map was met in this episode.
    has_begun: bool,
    visits: BTreeMap<Cell, u32>,
    collisions: BTreeMap<(Cell, Action), u32>,
}

impl Detours {
    /// Returns the cell that the percept shows.
    fn cell(&self, percept: &Percept) -> Cell {
        let end = percept.width();
        let [of_col, of_row] = self.place_bits;
        let number = |bits: Range<usize>| {
            bits.fold(0, |number, at| number << 1 | u16::from(percept.bit(at)))
        };
        Cell {
            col: number(end - of_row - of_col..end - of_row),
            row: number(end - of_row..end),
        }
    }

    /// Returns true if the percept shows that the move of an action is closed.
    fn is_closed(&self, percept: &Percept, action: Action) -> bool {
        let first = self.bits * action.index();
        self.bits > 0 && !percept.bit(first) && percept.bit(first + 1)
    }

    /// Returns true if the percept shows a move as closed that is open in the map.
    fn sees_obstacle(&self, percept: &Percept) -> bool {
        let cell = self.cell(percept);
        let is_in_map = |action| {
            let direction = self.maze.direction(action);
            direction.is_none_or(|direction| self.maze.step(cell, direction).is_none())
        };
        Action::all(self.maze.action_count())
            .any(|action| self.is_closed(percept, action) && !is_in_map(action))
    }

    /// Returns how late an action comes: 0 for the first ones.
    fn level(&self, cell: Cell, action: Action) -> u32 {
        let direction = self.maze.direction(action);
        let next = direction.and_then(|direction| self.maze.neighbour(cell, direction));
        let visits = next.and_then(|next| self.visits.get(&next)).unwrap_or(&0);
        let collisions = self.collisions.get(&(cell, action)).unwrap_or(&0);
        visits / VISITS + collisions
    }

    /// Returns the open actions that come first. If all are closed, all count as open.
    fn candidates(&self, percept: &Percept) -> Vec<Action> {
        let all = Action::all(self.maze.action_count());
        let is_open = |action: &Action| !self.is_closed(percept, *action);
        let mut open: Vec<Action> = all.clone().filter(is_open).collect();
        if open.is_empty() {
            open = all.collect();
        }
        let cell = self.cell(percept);
        let least = open.iter().map(|&action| self.level(cell, action)).min();
        open.retain(|&action| Some(self.level(cell, action)) == least);
        open
    }
}

impl Frozen {
    /// Creates an agent with `actions` actions and at most `step_threshold` steps an episode.
    pub fn new(knowledge: Knowledge, actions: usize, step_threshold: u32) -> Self {
        Self {
            knowledge,
            actions,
            step_threshold,
            detours: None,
        }
    }

    /// Lets the agent take another way where a move is blocked, with a percept that shows the cell.
    /// With another percept the agent stays as it is.
    #[must_use]
    pub fn with_detours(mut self, sensor: Sensor, maze: &Maze) -> Self {
        self.detours = sensor.tells_all_apart().then(|| Detours {
            bits: match sensor.begins_with_neighbours() {
                true => sensor.ring(self.actions) / self.actions,
                false => 0,
            },
            place_bits: sensor.place_bits(maze),
            maze: maze.clone(),
            has_begun: false,
            visits: BTreeMap::new(),
            collisions: BTreeMap::new(),
        });
        self
    }

    /// Returns an action around what is blocked, and whether it is by chance. Returns `None` if
    /// nothing speaks against the best actions.
    fn detour(
        &mut self,
        percept: &Percept,
        values: &PredictionArray,
        explorer: &mut Explorer,
    ) -> Option<(Action, bool)> {
        let detours = self.detours.as_mut()?;
        *detours.visits.entry(detours.cell(percept)).or_default() += 1;
        detours.has_begun |= detours.sees_obstacle(percept);
        if !detours.has_begun {
            return None;
        }
        let candidates = detours.candidates(percept);
        let mut best = values.best_actions();
        if values.greatest().is_some() && best.all(|action| candidates.contains(&action)) {
            return None;
        }
        let mut known = PredictionArray::new(self.actions);
        for &action in &candidates {
            if let Some(value) = values.get(action) {
                known.set(action, value);
            }
        }
        Some(match known.greatest() {
            Some(_) => (explorer.exploit(&known), false),
            None => (explorer.among(candidates.into_iter()), true),
        })
    }

    /// Returns the condition of the rule with the most weight among those that match a percept and advocate `action`;
    /// `None` if there is none.
    pub fn decisive_rule(&self, percept: &Percept, action: Action) -> Option<Condition> {
        self.matching(percept, action).fired
    }

    /// Describes the rules that match a percept; empty for a table.
    fn matching(&self, percept: &Percept, action: Action) -> StepCredit {
        match self.knowledge.rules() {
            Some(rules) => credit_of_rules(rules, percept, action),
            None => StepCredit::default(),
        }
    }
}

impl Agent for Frozen {
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.values(percept)
    }

    fn choose(
        &mut self,
        percept: &Percept,
        values: &PredictionArray,
        explorer: &mut Explorer,
    ) -> Choice {
        let (action, by_chance) = self.detour(percept, values, explorer).unwrap_or_else(|| {
            let (action, explores) = explorer.choose(values);
            (action, explores || values.greatest().is_none())
        });
        let source = match self.knowledge.rules() {
            Some(_) => DecisionSource::Rules,
            None => DecisionSource::Table,
        };
        Choice::by(source, action, by_chance)
    }

    fn update(&mut self, step: &Transition<'_>) -> StepCredit {
        let is_blocked = matches!(step.outcome, Outcome::Collided { .. } | Outcome::Stalled);
        if let (true, Some(detours)) = (is_blocked, &mut self.detours) {
            let cell = detours.cell(step.percept);
            detours.has_begun = true;
            *detours.collisions.entry((cell, step.action)).or_default() += 1;
        }
        self.matching(step.percept, step.action)
    }

    fn end_episode(&mut self, _: bool) -> EndCredit {
        if let Some(detours) = &mut self.detours {
            detours.has_begun = false;
            detours.visits.clear();
            detours.collisions.clear();
        }
        EndCredit::new(0.0, 0.0)
    }

    fn step_threshold(&self) -> u32 {
        self.step_threshold
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.knowledge.values(percept, self.actions)
    }

    fn knowledge(&self) -> Knowledge {
        self.knowledge.clone()
    }

    fn rule_count(&self) -> usize {
        self.knowledge.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcs::random::Stream;

    /// A hall of two rows.
    fn hall() -> Maze {
        let rows = br######"{ "rows": ["#####", "#S.G#", "#...#", "#####"] }"######;
        Maze::from_json(rows, "hall.json").unwrap()
    }

    /// The percept in a column of the upper row, with or without a box in the east.
    fn percept(col: u16, has_box: bool) -> Percept {
        let percept = Sensor::LidarPosition.perceive_at(&hall(), Cell { col, row: 1 });
        let bits = (0..percept.width()).map(|at| percept.bit(at) || (has_box && at == 5));
        Percept::from_bits(bits).unwrap()
    }

    /// The actions after these percepts, each with its outcome. The policy goes east rather than
    /// west, south and north.
    fn chosen(takes_detours: bool, steps: &[(Percept, Outcome)]) -> Vec<usize> {
        let values = [1.0, 4.0, 2.0, 3.0].map(Some).to_vec();
        let all = [1, 2].map(|col| [false, true].map(|has_box| percept(col, has_box)));
        let table = all.concat().into_iter().map(|one| (one, values.clone()));
        let mut policy = Frozen::new(Knowledge::Table(table.collect()), 4, 9);
        if takes_detours {
            policy = policy.with_detours(Sensor::LidarPosition, &hall());
        }
        let mut greedy = Explorer::new(0.0, Stream::new(1, 0_u64));
        let step = |&(percept, outcome): &(Percept, Outcome)| {
            let values = policy.observe(&percept);
            let action = policy.choose(&percept, &values, &mut greedy).action;
            policy.update(&Transition {
                percept: &percept,
                place: None,
                action,
                outcome,
                next: None,
            });
            action.index()
        };
        steps.iter().map(step).collect()
    }

    #[test]
    fn a_move_that_the_percept_shows_as_closed_is_not_taken() {
        let steps = [false, true].map(|has_box| (percept(1, has_box), Outcome::Moved));
        assert_eq!(chosen(true, &steps), [1, 2]);
        assert_eq!(chosen(false, &steps), [1, 1], "control");
    }

    #[test]
    fn after_a_collision_another_way_is_taken() {
        let hit = Outcome::Collided { impulse_n_s: None };
        let steps = [hit, Outcome::Moved].map(|outcome| (percept(1, false), outcome));
        assert_eq!(chosen(true, &steps), [1, 2]);
        assert_eq!(chosen(false, &steps), [1, 1], "control");
    }

    #[test]
    fn a_robot_in_front_of_a_box_does_not_turn_back_and_forth_for_ever() {
        let percepts = [percept(1, false), percept(2, true)];
        let steps = [percepts, percepts].concat();
        let steps: Vec<_> = steps.into_iter().map(|one| (one, Outcome::Moved)).collect();
        assert_eq!(chosen(true, &steps), [1, 3, 1, 2]);
        assert_eq!(chosen(false, &steps), [1; 4], "control");
    }
}
