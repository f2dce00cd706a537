//! Maps as a table of states.

use serde::Serialize;

use crate::agent::{Map, pomdp::GOAL};
use crate::export::quantised::{ExportError, MOST_STATES};
use xcs::Action;

/// The maps of a map with at most [`MOST_STATES`] states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapTable {
    /// The state in which all episodes begin, if that is known.
    pub begin: Option<u16>,
    /// The probability that another action than the chosen one is executed, each with the same chance.
    pub slip: f64,
    /// The probability that a cell is misread.
    #[serde(rename = "observation_error")]
    pub observation_error: f64,
    /// Does the tracker not look at whether the robot bumped?
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub unfelt: bool,
    states: Vec<State>,
}

/// A state: a place, and what was found before.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct State {
    /// What is perceived.
    pub percept: u16,
    /// Cells to the east of the goal.
    pub x: i16,
    /// Cells to the north of it.
    pub y: i16,
    /// The number of the map.
    #[serde(rename = "map")]
    pub map: u8,
    /// As bits: which rewards of the map were found.
    pub collected: u8,
    /// By action: the state that it leads to; none for the goal.
    pub next: Vec<Option<u16>>,
}

impl MapTable {
    /// The maps of a map.
    ///
    /// # Errors
    /// When it has no states, or too many.
    pub fn new(map: &Map) -> Result<Self, ExportError> {
        match map.pomdp.states() {
            0 => return Err(ExportError::Empty),
            1..=MOST_STATES => {}
            many => return Err(ExportError::Vast(many)),
        }
        Ok(Self {
            states: (0..map.pomdp.states() as u32)
                .map(|at| State::new(map, at))
                .collect(),
            begin: map.begin.and_then(number),
            slip: map.pomdp.slip(),
            observation_error: map.observation_error,
            unfelt: map.unfelt,
        })
    }

    /// How many rewards the maps know.
    pub fn rewards(&self) -> u32 {
        let found = self.states.iter().map(|state| state.collected.count_ones());
        found.max().unwrap_or(0)
    }

    /// All states.
    pub fn states(&self) -> &[State] {
        &self.states
    }

    /// What they take as constants, and what a tracker does that has so many bytes beside its beliefs,
    /// as lines for a comment.
    pub fn costs(&self, actions: usize, beside: usize) -> String {
        let (states, state) = (self.states.len(), 2 * actions + 6);
        let (weight, kind) = match self.is_exact() {
            true => (2, "whole numbers"),
            false => (8, "doubles"),
        };
        let tracker = (2 * states * weight + beside).next_multiple_of(weight.max(4));
        format!(
            "It takes {states} states of {state} bytes, together {} bytes of constants, and {tracker} bytes of \
             memory\nfor a tracker. Beliefs are {kind}. No allocation, no recursion, no libm.\n",
            states * state
        )
    }

    /// Are moves exact and percepts right? Then beliefs are whole numbers.
    pub fn is_exact(&self) -> bool {
        self.slip == 0.0 && self.observation_error == 0.0
    }
}

impl State {
    fn new(map: &Map, at: u32) -> Self {
        let map_state = &map.states[at as usize];
        let actions = Action::all(map.pomdp.actions());
        Self {
            percept: map.pomdp.percept(at).words()[0] as u16,
            x: map_state.place.east,
            y: map_state.place.north,
            map: map_state.cell_map,
            collected: map_state.collected,
            next: actions
                .map(|action| number(map.pomdp.next(at, action)))
                .collect(),
        }
    }

    /// The states that the actions lead to as a list, with this for the goal.
    pub fn successors(&self, goal: &str) -> String {
        let next: Vec<String> = self.next.iter().map(|&next| named(next, goal)).collect();
        next.join(", ")
    }
}

/// A state, or the name of none.
pub fn named(state: Option<u16>, none: &str) -> String {
    state.map_or(none.to_owned(), |state| state.to_string())
}

fn number(state: u32) -> Option<u16> {
    (state != GOAL).then_some(state as u16)
}
