//! Percepts that are followed by the last steps of the episode.
//!
//! Each earlier step adds one bit for each action, of which the bit of the action taken is 1, and the percept in which
//! it was taken. All these bits are 0 if there was no such step, because the episode began later.

use std::ops::Range;

use super::Sensor;
use super::words::{Alleles, Demands};
use crate::world::{Cell, Maze};
use xcs::{Action, Percept};

/// The maximum number of earlier steps in a percept.
pub const MOST_EARLIER_STEPS: u32 = 3;
/// What words about earlier steps begin with.
const AGO: [&str; MOST_EARLIER_STEPS as usize] =
    ["one step ago", "two steps ago", "three steps ago"];

/// A sensor, and the number of earlier steps that follow its percept (`sensor.history`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Perception {
    /// The sensor.
    pub sensor: Sensor,
    /// The number of earlier steps.
    pub history: u32,
}

impl From<Sensor> for Perception {
    fn from(sensor: Sensor) -> Self {
        Self { sensor, history: 0 }
    }
}

impl Perception {
    /// Returns the width of a percept with its earlier steps, in bits.
    pub fn width(self, maze: &Maze) -> usize {
        self.sensor.width(maze) + self.history as usize * step_width(self.sensor, maze)
    }

    /// Returns the percept in the middle of a free cell, at the beginning of an episode.
    pub fn at(self, maze: &Maze, cell: Cell) -> Percept {
        History::new(self, maze).behind(&self.sensor.perceive_at(maze, cell))
    }

    /// Returns every percept that occurs at the beginning of an episode in a free, non-goal cell of a maze, each once,
    /// in order; `None` if there are more than `most`.
    pub fn at_most_percepts(self, maze: &Maze, most: usize) -> Option<Vec<Percept>> {
        let mut percepts = self.sensor.at_most_percepts(maze, most)?;
        let history = History::new(self, maze);
        percepts
            .iter_mut()
            .for_each(|percept| *percept = history.behind(percept));
        Some(percepts)
    }
}

/// Returns the number of bits of an earlier step.
fn step_width(sensor: Sensor, maze: &Maze) -> usize {
    maze.action_count() + sensor.width(maze)
}

/// The last steps of an episode, the latest first, as bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct History {
    bits: Percept,
    actions: usize,
}

impl Default for History {
    /// Returns a history that keeps no steps.
    fn default() -> Self {
        Self {
            bits: Percept::from_word(0, 0),
            actions: 0,
        }
    }
}

impl History {
    /// Returns the history at the beginning of an episode.
    pub fn new(perception: Perception, maze: &Maze) -> Self {
        let width = perception.width(maze) - perception.sensor.width(maze);
        Self {
            bits: cut(std::iter::repeat(false), width),
            actions: maze.action_count(),
        }
    }

    /// Returns true if the history keeps steps.
    pub fn keeps_steps(&self) -> bool {
        self.bits.width() > 0
    }

    /// Returns the history after `action` was taken in a percept without history.
    #[must_use]
    pub fn after(&self, percept: &Percept, action: Action) -> Self {
        let taken = Percept::from_word(1 << action.index(), self.actions);
        let bits = taken.followed_by(percept).followed_by(&self.bits);
        Self {
            bits: cut((0..bits.width()).map(|at| bits.bit(at)), self.bits.width()),
            actions: self.actions,
        }
    }

    /// Returns a percept, followed by the earlier steps.
    pub fn behind(&self, percept: &Percept) -> Percept {
        percept.followed_by(&self.bits)
    }
}

/// Collects the first `width` bits.
fn cut(bits: impl Iterator<Item = bool>, width: usize) -> Percept {
    Percept::from_bits(bits.take(width)).expect("three steps of any sensor fit into a percept")
}

/// What a condition requires of the bits from `first` on.
struct Rest<'a> {
    first: usize,
    alleles: Alleles<'a>,
}

impl Demands for Rest<'_> {
    fn allele(&self, at: usize) -> Option<bool> {
        self.alleles.allele(self.first + at)
    }

    fn range(&self, bits: Range<usize>) -> Option<[u16; 2]> {
        self.alleles
            .range(self.first + bits.start..self.first + bits.end)
    }
}

impl Sensor {
    /// Describes what a condition requires of the earlier steps, for example `one step ago: went east`.
    pub(super) fn words_of_history(self, maze: &Maze, alleles: Alleles<'_>) -> Vec<String> {
        let first = self.width(maze);
        let kept = alleles.width().unwrap_or(first).saturating_sub(first);
        let step = step_width(self, maze);
        let of_step = |(number, ago): (usize, &&str)| {
            let alleles = Rest {
                first: first + number * step,
                alleles,
            };
            let words = self.words_of_step(maze, &alleles).into_iter();
            words.map(|word| format!("{ago}: {word}")).collect()
        };
        let steps = AGO.iter().take(kept / step).enumerate();
        steps
            .flat_map(|step| -> Vec<String> { of_step(step) })
            .collect()
    }

    fn words_of_step(self, maze: &Maze, alleles: &Rest<'_>) -> Vec<String> {
        let actions = maze.action_count();
        let named = |wanted: bool| {
            let all = Action::all(actions);
            let named = all.filter(move |action| alleles.allele(action.index()) == Some(wanted));
            let names: Vec<String> = named.map(|action| maze.action_name(action)).collect();
            names
        };
        let (taken, others) = (named(true), named(false));
        if others.len() == actions {
            return vec!["no step".to_owned()];
        }
        let went = match (&taken[..], &others[..]) {
            ([], []) => None,
            ([], others) => Some(format!("did not go {}", others.join(" or "))),
            (taken, _) => Some(format!("went {}", taken.join(" and "))),
        };
        let percept = Rest {
            first: alleles.first + actions,
            alleles: alleles.alleles,
        };
        let percept = self.words_of_percept(maze, &percept);
        went.into_iter().chain(percept).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcs::Condition;

    fn maze() -> Maze {
        let text = br######"{"rows": ["#####", "#S.G#", "#####"]}"######;
        Maze::from_json(text, "corridor.json").unwrap()
    }

    fn perception(history: u32) -> Perception {
        let sensor = Sensor::Neighbours;
        Perception { sensor, history }
    }

    #[test]
    fn the_latest_step_comes_first_and_the_oldest_is_forgotten() {
        let maze = maze();
        let [east, west] = [1, 3].map(|index| Action::new(index).unwrap());
        let [a, b] = [1, 2].map(|col| Sensor::Neighbours.perceive_at(&maze, Cell { col, row: 1 }));
        let empty = History::new(perception(2), &maze);
        let zeros = "0".repeat(20);
        assert_eq!(empty.behind(&a).to_string(), format!("{a}{zeros}{zeros}"));
        let one = empty.after(&a, east);
        assert_eq!(one.behind(&b).to_string(), format!("{b}0100{a}{zeros}"));
        let two = one.after(&b, west);
        assert_eq!(two.behind(&a).to_string(), format!("{a}0001{b}0100{a}"));
        let three = two.after(&a, east);
        assert_eq!(three.behind(&b).to_string(), format!("{b}0100{a}0001{b}"));
        let none = History::new(perception(0), &maze);
        assert_eq!(none.after(&a, east).behind(&b), b, "control: no history");
    }

    #[test]
    fn three_steps_of_every_sensor_fit_into_a_percept() {
        let rows = vec![".".repeat(300); 300].join("\", \"");
        let text = format!(
            r#"{{"moves": 8, "wrap": true, "rows": ["G{}", "{rows}"]}}"#,
            ".".repeat(299)
        );
        let maze = Maze::from_json(text.as_bytes(), "open.json").unwrap();
        for &sensor in Sensor::ALL {
            let perception = Perception { sensor, history: 3 };
            let cell = Cell { col: 299, row: 299 };
            let percept = perception.at(&maze, cell);
            assert_eq!(percept.width(), perception.width(&maze), "{sensor:?}");
        }
    }

    #[test]
    fn earlier_steps_are_described_in_words() {
        let words = |condition: &str| {
            let condition: Condition = condition.parse().unwrap();
            Sensor::Neighbours.words(&maze(), &condition)
        };
        let hashes = |count| "#".repeat(count);
        let east = format!("01{}#1##{}", hashes(14), hashes(16));
        assert_eq!(words(&east), "north wall, one step ago: went east");
        let others = format!("{}0#0#01{}0000{}", hashes(16), hashes(14), hashes(16));
        assert_eq!(
            words(&others),
            "one step ago: did not go north or south, one step ago: north wall, two steps ago: no step"
        );
        assert_eq!(words(&hashes(56)), "anything");
    }
}
