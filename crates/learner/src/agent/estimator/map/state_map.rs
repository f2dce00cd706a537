//! Converts maps into a POMDP to plan with.

use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

use crate::agent::credit::params::Params;
use crate::agent::estimator::belief::Belief;
use crate::agent::estimator::map::cell_counts::{CellCounts, FURTHEST};
use crate::agent::estimator::map::place::{CellState, Place, Vision, offset, percept_of};
use crate::agent::estimator::map::reward_map::RewardMap;
use crate::agent::model::pomdp::{GOAL, Pomdp};
use crate::agent::model::rewards::RewardModel;
use xcs::{Action, Percept};

/// The maximum number of maps, one per distinguishable goal.
pub const MOST_MAPS: usize = 6;
/// The maximum number of rewarded cells of a map in plans: the ones nearest to the goal.
pub const MOST_PAYING: usize = 4;
/// The maximum number of states of a map with rewarded cells. Each rewarded cell doubles the states.
const MOST_STATES: usize = 1 << 14;
/// The bits that encode the number of collected rewards.
const FOUND_BITS: usize = 3;

/// The robot's cell and the collected rewards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub struct MapState {
    /// A bit set of the map's rewarded cells that were collected in this episode.
    pub collected: u8,
    /// The number of the map.
    #[serde(rename = "map")]
    pub cell_map: u8,
    /// The cell on the map.
    pub place: Place,
}

/// The states of all maps to plan with.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(try_from = "ReadMap")]
pub struct Map {
    /// The transitions and the percepts.
    pub pomdp: Pomdp,
    /// By state number. The possible first states of episodes come first.
    pub states: Vec<MapState>,
    /// The probability that a cell is observed wrongly; 0 if percepts are treated as correct.
    pub observation_error: f64,
    /// The state in which all episodes begin, if there is one.
    pub begin: Option<u32>,
    /// True if the robot has no bumper.
    pub unfelt: bool,
}

/// A map as read from a file, before validation.
#[derive(Deserialize)]
struct ReadMap {
    pomdp: Pomdp,
    states: Vec<MapState>,
    #[serde(default)]
    observation_error: f64,
    #[serde(default)]
    begin: Option<u32>,
    #[serde(default)]
    unfelt: bool,
}

impl Serialize for Map {
    /// Human-readable files contain `unfelt` only if it is true.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let with_unfelt = self.unfelt || !serializer.is_human_readable();
        let mut map = serializer.serialize_struct("Map", 4 + usize::from(with_unfelt))?;
        map.serialize_field("pomdp", &self.pomdp)?;
        map.serialize_field("states", &self.states)?;
        map.serialize_field("observation_error", &self.observation_error)?;
        map.serialize_field("begin", &self.begin)?;
        if with_unfelt {
            map.serialize_field("unfelt", &self.unfelt)?;
        }
        map.end()
    }
}

impl TryFrom<ReadMap> for Map {
    type Error = &'static str;

    fn try_from(read: ReadMap) -> Result<Self, Self::Error> {
        let map = Self {
            pomdp: read.pomdp,
            states: read.states,
            observation_error: read.observation_error,
            begin: read.begin,
            unfelt: read.unfelt,
        };
        match map.is_valid(map.pomdp.actions()) {
            true => Ok(map),
            false => Err("the map of the rules contradicts itself"),
        }
    }
}

/// A map with its rewarded cells.
pub struct MappedCells<'a> {
    cell_map: &'a CellCounts,
    vision: Vision,
    /// The cells whose percept is completely known.
    places: Vec<Place>,
    paying: Vec<(Place, f64)>,
}

impl<'a> MappedCells<'a> {
    /// Collects all cells of a map whose percept is completely known, and their rewards.
    pub fn new(cell_map: &'a CellCounts, payments: &RewardMap, vision: Vision) -> Self {
        let is_mapped = |place: &Place| {
            *place != Place::ORIGIN
                && cell_map.cell_state(*place) == Some(CellState::Free)
                && cell_map.around(*place, vision).is_some()
        };
        let places: Vec<Place> = cell_map.places().filter(is_mapped).collect();
        let mut paying = payments.likely();
        paying.retain(|(place, _)| is_mapped(place));
        let room = (MOST_STATES / places.len().max(1)).max(1).ilog2() as usize;
        paying.truncate(room.min(MOST_PAYING));
        Self {
            cell_map,
            vision,
            places,
            paying,
        }
    }

    /// Returns all states of the map, whose number is `cell_map`.
    fn states(&self, cell_map: u8) -> impl Iterator<Item = MapState> + '_ {
        let collected = 0..1_u8 << self.paying.len();
        collected.flat_map(move |collected| {
            let places = self.places.iter();
            places.map(move |&place| MapState {
                collected,
                cell_map,
                place,
            })
        })
    }

    /// Returns the collected rewards after the robot enters a cell, given those `collected` before.
    fn collected_in(&self, place: Place, collected: u8) -> u8 {
        let at = self.paying.iter().position(|paying| paying.0 == place);
        at.map_or(collected, |at| collected | 1 << at)
    }

    /// Returns the sum of the collected rewards.
    fn paid(&self, collected: u8) -> f64 {
        let paying = self.paying.iter().enumerate();
        let paid = paying.filter(|(at, _)| collected >> at & 1 == 1);
        paid.map(|(_, (_, reward))| reward).sum()
    }
}

impl Map {
    /// Builds the states and the POMDP of some maps. `aims` holds the displacement of each action, if it is
    /// certain, and `slip` the slip probability.
    pub fn build(
        mapped: &[MappedCells<'_>],
        aims: &[Option<usize>],
        slip: f64,
        params: &Params,
    ) -> Self {
        if mapped.is_empty() {
            return Self::default();
        }
        let all = mapped.iter().enumerate();
        let mut states: Vec<MapState> = all.flat_map(|(at, one)| one.states(at as u8)).collect();
        states.sort_unstable();
        let on = |map_state: &MapState| &mapped[usize::from(map_state.cell_map)];
        let seen: Vec<Percept> = states
            .iter()
            .map(|map_state| {
                let around = on(map_state)
                    .cell_map
                    .around(map_state.place, on(map_state).vision);
                let around = around.expect("only places that are mapped all around");
                sight(&percept_of(&around), map_state.collected.count_ones())
            })
            .collect();
        let next = |state: usize, action: Action| match aims[action.index()] {
            Some(heading) => next(&states, on(&states[state]), state, heading),
            None => state as u32,
        };
        let mut pomdp = Pomdp::new(aims.len(), slip, &seen, next);
        if mapped.iter().any(|one| !one.paying.is_empty()) {
            let found = states
                .iter()
                .map(|map_state| on(map_state).paid(map_state.collected))
                .collect();
            let &Params {
                goal, step, gamma, ..
            } = params;
            pomdp = pomdp.with_rewards(RewardModel::new(gamma, goal, step, found));
        }
        Self {
            pomdp,
            states,
            observation_error: 0.0,
            begin: None,
            unfelt: false,
        }
    }

    /// Returns the map with a fixed first state: this cell of this map.
    pub fn with_first_state(self, begun: Option<(u8, Place)>) -> Self {
        let state = begun.and_then(|(cell_map, place)| {
            let collected = 0;
            let map_state = MapState {
                collected,
                cell_map,
                place,
            };
            self.states.binary_search(&map_state).ok()
        });
        let begin = state.map(|state| state as u32);
        Self { begin, ..self }
    }

    /// Returns the first belief of a simulated episode that begins in a state. If all episodes have the
    /// same first state, the belief is certain of `start`: other starts serve to plan for a mislocalised
    /// robot.
    pub fn first_belief(&self, start: u32) -> Belief {
        match self.begin {
            Some(_) => Belief::even([start]),
            None => Belief::even(self.pomdp.aliased(self.pomdp.look(start))),
        }
    }

    /// Returns true if both maps have the same cells, whatever the observation error.
    pub fn has_same_states(&self, other: &Self) -> bool {
        self.pomdp == other.pomdp && self.states == other.states && self.begin == other.begin
    }

    /// Returns the number of possible first states: those without collected rewards.
    pub fn starts(&self) -> u32 {
        self.states
            .partition_point(|map_state| map_state.collected == 0) as u32
    }

    /// Returns true if the transition from one state to another collects a reward.
    pub fn pays(&self, from: u32, to: u32) -> bool {
        let [from, to] = [from, to].map(|state| self.states[state as usize].collected);
        from != to
    }

    /// Returns the number of rewarded cells on the map.
    pub fn rewards(&self) -> u32 {
        let collected = self
            .states
            .iter()
            .map(|map_state| map_state.collected.count_ones());
        collected.max().unwrap_or(0)
    }

    /// Returns true if the map is valid for this number of actions.
    pub fn is_valid(&self, actions: usize) -> bool {
        let mapped = |map_state: &MapState| {
            usize::from(map_state.cell_map) < MOST_MAPS
                && map_state.place.reach() <= FURTHEST
                && map_state.collected < 1 << MOST_PAYING
        };
        let empty = self.states.is_empty() && self.pomdp == Pomdp::default();
        (0.0..=1.0).contains(&self.observation_error)
            && self.begin.is_none_or(|begin| begin < self.starts())
            && (empty
                || self.pomdp.actions() == actions
                    && self.pomdp.is_valid()
                    && self.pomdp.states() == self.states.len()
                    && self.states.is_sorted()
                    && self.states.iter().all(mapped))
    }
}

/// Returns the successor of a state for a move in a direction.
fn next(states: &[MapState], on: &MappedCells<'_>, state: usize, heading: usize) -> u32 {
    let map_state = states[state];
    let place = map_state.place.plus(offset(heading));
    match on.cell_map.cell_state(place) {
        Some(CellState::Goal) => GOAL,
        _ if place == Place::ORIGIN => GOAL,
        Some(CellState::Free) => {
            let collected = on.collected_in(place, map_state.collected);
            let known = states.binary_search(&MapState {
                collected,
                place,
                ..map_state
            });
            known.unwrap_or(state) as u32
        }
        _ => state as u32,
    }
}

/// Returns the percept extended by the number of rewards collected in the episode.
pub fn sight(percept: &Percept, found: u32) -> Percept {
    percept.followed_by(&Percept::from_word(found.into(), FOUND_BITS))
}
