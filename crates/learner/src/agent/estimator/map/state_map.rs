//! Maps as a world to plan in.

use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

use crate::agent::estimator::belief::Belief;
use crate::agent::estimator::map::cell_counts::{CellCounts, FURTHEST};
use crate::agent::estimator::map::place::{CellState, Place, Vision, offset, percept_of};
use crate::agent::estimator::map::reward_map::RewardMap;
use crate::agent::model::pomdp::{GOAL, Pomdp};
use crate::agent::model::rewards::RewardModel;
use xcs::{Action, Percept};

/// The most maps: goals that can be told apart.
pub const MOST_MAPS: usize = 6;
/// The cells of a map that pay by themselves and are planned with, at most: the nearest to the goal.
pub const MOST_PAYING: usize = 4;
/// States of a map at most, if some of its cells pay; each of these doubles them.
const MOST_STATES: usize = 1 << 14;
/// The bits of how many rewards were found.
const FOUND_BITS: usize = 3;

/// What is sought: the setting `reward`, as far as it matters here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RewardScale {
    /// What the goal pays.
    pub goal: f64,
    /// What a step pays.
    pub step: f64,
    /// The discount per step.
    pub gamma: f64,
}

/// Where a robot is, and what it has found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub struct MapState {
    /// As bits: which of the paying cells of the map have paid in this episode.
    pub collected: u8,
    /// The number of the map.
    #[serde(rename = "map")]
    pub cell_map: u8,
    /// The place on it.
    pub place: Place,
}

/// Spots as states to plan on.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(try_from = "ReadMap")]
pub struct Map {
    /// What moves do, and what is perceived.
    pub pomdp: Pomdp,
    /// By state; those in which an episode may begin come first.
    pub states: Vec<MapState>,
    /// The probability that a cell is misread; 0 if what is perceived is taken for right.
    pub observation_error: f64,
    /// The state in which all episodes begin, if there is one.
    pub begin: Option<u32>,
    /// Can the robot not feel whether it bumped?
    pub unfelt: bool,
}

/// A map as it stands in a file, which nobody has looked at.
#[derive(Deserialize)]
struct ReadMap {
    pomdp: Pomdp,
    #[serde(rename = "states")]
    states: Vec<MapState>,
    #[serde(default, rename = "observation_error")]
    observation_error: f64,
    #[serde(default)]
    begin: Option<u32>,
    #[serde(default)]
    unfelt: bool,
}

impl Serialize for Map {
    /// What files for people say of bumps is only that they are not felt.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let says = self.unfelt || !serializer.is_human_readable();
        let mut map = serializer.serialize_struct("Map", 4 + usize::from(says))?;
        map.serialize_field("pomdp", &self.pomdp)?;
        map.serialize_field("states", &self.states)?;
        map.serialize_field("observation_error", &self.observation_error)?;
        map.serialize_field("begin", &self.begin)?;
        if says {
            map.serialize_field("unfelt", &self.unfelt)?;
        }
        map.end()
    }
}

impl TryFrom<ReadMap> for Map {
    type Error = &'static str;

    fn try_from(read: ReadMap) -> Result<Self, Self::Error> {
        let ReadMap {
            pomdp,
            states,
            observation_error,
            begin,
            unfelt,
        } = read;
        let map = Self {
            pomdp,
            states,
            observation_error,
            begin,
            unfelt,
        };
        match map.is_sound(map.pomdp.actions()) {
            true => Ok(map),
            false => Err("the map that the rules go by contradicts itself"),
        }
    }
}

/// A map, and the cells of it that pay.
pub struct MappedCells<'a> {
    cell_map: &'a CellCounts,
    vision: Vision,
    /// The places that can be perceived wholly.
    places: Vec<Place>,
    paying: Vec<(Place, f64)>,
}

impl<'a> MappedCells<'a> {
    /// All places of a map that can be perceived wholly, and what they pay.
    pub fn new(cell_map: &'a CellCounts, payments: &RewardMap, vision: Vision) -> Self {
        let stands = |place: &Place| {
            *place != Place::ORIGIN
                && cell_map.cell_state(*place) == Some(CellState::Free)
                && cell_map.around(*place, vision).is_some()
        };
        let places: Vec<Place> = cell_map.places().filter(stands).collect();
        let mut paying = payments.likely();
        paying.retain(|(place, _)| stands(place));
        let room = (MOST_STATES / places.len().max(1)).max(1).ilog2() as usize;
        paying.truncate(room.min(MOST_PAYING));
        Self {
            cell_map,
            vision,
            places,
            paying,
        }
    }

    /// All spots of the map with this number.
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

    /// What has been collected once a robot comes into a place, if it was `collected` before.
    fn collected_in(&self, place: Place, collected: u8) -> u8 {
        let at = self.paying.iter().position(|paying| paying.0 == place);
        at.map_or(collected, |at| collected | 1 << at)
    }

    /// What was paid in all.
    fn paid(&self, collected: u8) -> f64 {
        let paying = self.paying.iter().enumerate();
        let paid = paying.filter(|(at, _)| collected >> at & 1 == 1);
        paid.map(|(_, (_, reward))| reward).sum()
    }
}

impl Map {
    /// The map of some maps, for a robot whose actions aim there, as far as that is certain, and slip
    /// so often.
    pub fn drawn(
        mapped: &[MappedCells<'_>],
        aims: &[Option<usize>],
        slip: f64,
        values: &RewardScale,
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
            let RewardScale { goal, step, gamma } = *values;
            pomdp = pomdp.with_prizes(RewardModel::new(gamma, goal, step, found));
        }
        Self {
            pomdp,
            states,
            observation_error: 0.0,
            begin: None,
            unfelt: false,
        }
    }

    /// The same, where all episodes begin in this place of this map.
    pub fn begun_in(self, begun: Option<(u8, Place)>) -> Self {
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

    /// What is believed when an imagined episode begins in a state. Who knows where episodes begin is
    /// sure of any start: plans from elsewhere are for when it has lost its way.
    pub fn first_belief(&self, start: u32) -> Belief {
        match self.begin {
            Some(_) => Belief::even([start]),
            None => self.pomdp.first_belief(self.pomdp.look(start)),
        }
    }

    /// Is it the map of the same cells, however often they are misread?
    pub fn is_of_the_same(&self, other: &Self) -> bool {
        self.pomdp == other.pomdp && self.states == other.states && self.begin == other.begin
    }

    /// The states in which an episode may begin: nothing was found yet.
    pub fn starts(&self) -> u32 {
        self.states
            .partition_point(|map_state| map_state.collected == 0) as u32
    }

    /// Does it pay to come from one state into another?
    pub fn pays(&self, from: u32, to: u32) -> bool {
        let [from, to] = [from, to].map(|state| self.states[state as usize].collected);
        from != to
    }

    /// Returns how many cells with a reward the map knows.
    pub fn rewards(&self) -> u32 {
        let collected = self
            .states
            .iter()
            .map(|map_state| map_state.collected.count_ones());
        collected.max().unwrap_or(0)
    }

    /// Is it a map for so many actions, of places on maps?
    pub fn is_sound(&self, actions: usize) -> bool {
        let mapped = |map_state: &MapState| {
            usize::from(map_state.cell_map) < MOST_MAPS
                && map_state.place.reach() <= FURTHEST
                && map_state.collected < 1 << MOST_PAYING
        };
        let blank = self.states.is_empty() && self.pomdp == Pomdp::default();
        (0.0..=1.0).contains(&self.observation_error)
            && self.begin.is_none_or(|begin| begin < self.starts())
            && (blank
                || self.pomdp.actions() == actions
                    && self.pomdp.is_sound()
                    && self.pomdp.states() == self.states.len()
                    && self.states.is_sorted()
                    && self.states.iter().all(mapped))
    }
}

/// The state that a move with a heading leads to.
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

/// What a robot perceives, and how many rewards it has found in the episode.
pub fn sight(percept: &Percept, found: u32) -> Percept {
    percept.followed_by(&Percept::from_word(found.into(), FOUND_BITS))
}
