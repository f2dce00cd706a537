//! Maps as a table of states.

use serde::Serialize;

use super::policy::{MOST_STATES, nothing_learned};
use crate::agent::{GOAL, Map};
use crate::error::{Error, ErrorKind};
use xcs::Action;

/// The maps of a learner, with at most [`MOST_STATES`] states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapTable {
    /// The state in which all episodes begin, if it is known.
    pub begin: Option<u16>,
    /// The probability that another action is executed than the chosen one. The other actions are
    /// equally likely.
    pub slip: f64,
    /// The probability that a cell is observed wrongly.
    #[serde(rename = "observation_error")]
    pub observation_error: f64,
    /// True if the tracker ignores collisions.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub unfelt: bool,
    states: Vec<State>,
}

/// A state: a cell of a map, and the rewards collected so far.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct State {
    /// The percept in this state.
    pub percept: u16,
    /// Cells to the east of the goal.
    pub x: i16,
    /// Cells to the north of the goal.
    pub y: i16,
    /// The number of the map.
    #[serde(rename = "map")]
    pub map: u8,
    /// A bit mask of the rewards of the map that were collected.
    pub collected: u8,
    /// The next state for each action; `None` for the goal.
    pub next: Vec<Option<u16>>,
}

impl MapTable {
    /// Converts a learner's maps to a table.
    ///
    /// # Errors
    /// When there are no states, or too many.
    pub fn new(map: &Map) -> Result<Self, Error> {
        match map.pomdp.states() {
            0 => return Err(nothing_learned()),
            1..=MOST_STATES => {}
            many => {
                return Err(ErrorKind::BadData.error(format!(
                    "the maps of the rules have {many} states, but at most {MOST_STATES} can be exported: \
                     train another method for export, such as xcscr-plus"
                )));
            }
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

    /// Returns the number of rewards on the maps.
    pub fn rewards(&self) -> u32 {
        let found = self.states.iter().map(|state| state.collected.count_ones());
        found.max().unwrap_or(0)
    }

    /// Returns true if moves and percepts are exact. Beliefs are then integers.
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
}

fn number(state: u32) -> Option<u16> {
    (state != GOAL).then_some(state as u16)
}
