//! A map around one goal: the number of observations of each cell state, by cell.

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::place::{
    CellState, NEIGHBOURS, Place, Surroundings, Vision, shown,
};

/// The maximum number of observations per cell. From there on, older ones fade.
const MOST_SIGHTINGS: u8 = 20;
/// The maximum distance of a mapped cell from the goal, in moves.
pub const FURTHEST: u16 = 64;
/// The weight of any observation of an unknown cell, relative to one that agrees with the map. It is not
/// a probability: a new cell counts nearly as much as an agreeing one, so that maps grow.
const UNKNOWN: f64 = 0.9;
/// The weight of a percept in unknown surroundings: `UNKNOWN` for each of nine cells.
pub const UNSEEN: f64 = 0.387_420_489;
/// Up to this observation error, contradicting observations were mostly made elsewhere, by a mislocalised
/// robot.
const RARE: f64 = 0.002;
/// The prior number of observations of each cell state.
const PRIOR: f64 = 0.003;

/// Observations of each cell state, for the cells of a growing rectangle.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct CellCounts {
    /// The south-western cell.
    corner: Place,
    width: u16,
    height: u16,
    sightings: Vec<[u8; 3]>,
}

impl CellCounts {
    /// Returns the observations of a cell: free, wall, goal.
    fn sightings(&self, place: Place) -> [u8; 3] {
        self.index(place).map_or([0; 3], |at| self.sightings[at])
    }

    fn index(&self, place: Place) -> Option<usize> {
        let Place { east, north } = place.minus(self.corner);
        let (col, row) = (u16::try_from(east).ok()?, u16::try_from(north).ok()?);
        let inside = col < self.width && row < self.height;
        inside.then_some(usize::from(row) * usize::from(self.width) + usize::from(col))
    }

    /// Returns the most frequently observed state of a cell; `None` if it was never observed.
    pub fn cell_state(&self, place: Place) -> Option<CellState> {
        let [free, wall, goal] = self.sightings(place);
        match free.max(wall).max(goal) {
            0 => None,
            most if most == free => Some(CellState::Free),
            most if most == wall => Some(CellState::Wall),
            _ => Some(CellState::Goal),
        }
    }

    /// Returns the observed cells with the counts of each state: free, wall, goal.
    pub fn seen(&self) -> impl Iterator<Item = (Place, [u8; 3])> + '_ {
        let cells = self.places().zip(self.sightings.iter().copied());
        cells.filter(|(_, seen)| *seen != [0; 3])
    }

    /// Returns the number of observed cells.
    pub fn cells(&self) -> usize {
        let seen = |sightings: &&[u8; 3]| sightings.iter().any(|count| *count > 0);
        self.sightings.iter().filter(seen).count()
    }

    /// Returns the expected percept in a cell; `None` if a part of it is not mapped.
    pub fn around(&self, place: Place, vision: Vision) -> Option<Surroundings> {
        vision.seen(NEIGHBOURS.map(|by| self.cell_state(place.plus(by))))
    }

    /// Returns the likelihood of a percept in a cell, given the probability `observation_error` that a
    /// cell is observed wrongly.
    pub fn likelihood(&self, place: Place, seen: &Surroundings, observation_error: f64) -> f64 {
        let here = self.state_likelihood(place, CellState::Free, observation_error);
        let cells = NEIGHBOURS.iter().zip(seen);
        cells.fold(here, |product, (&by, &state)| {
            product * self.state_likelihood(place.plus(by), state, observation_error)
        })
    }

    fn state_likelihood(&self, place: Place, state: CellState, observation_error: f64) -> f64 {
        if state == CellState::Hidden {
            // The walls that hide it are weighted themselves.
            return 1.0;
        }
        let sightings = self.sightings(place);
        let all: f64 = sightings.iter().copied().map(f64::from).sum();
        if all == 0.0 {
            return UNKNOWN;
        }
        if observation_error <= RARE {
            let share = (f64::from(sightings[state as usize]) + PRIOR) / (all + 3.0 * PRIOR);
            return (1.0 - observation_error) * share + observation_error / 3.0;
        }
        // The posterior of the cell's state by Bayes' theorem. Both wrong states are equally likely.
        let odds = (observation_error / 2.0) / (1.0 - observation_error);
        let seen: u8 = sightings.iter().sum();
        let truly = sightings.map(|count| (count..seen).fold(1.0, |share, _| share * odds));
        let share = truly[state as usize] / truly.iter().sum::<f64>();
        (1.0 - observation_error) * share + observation_error / 2.0 * (1.0 - share)
    }

    /// Returns the mapped cells around a place, and whether their perceived states agree with the map.
    pub fn compare(
        &self,
        place: Place,
        seen: &Surroundings,
    ) -> impl Iterator<Item = (Place, bool)> {
        let around = shown(place, seen).skip(1);
        around.filter_map(|(cell, state)| Some((cell, self.cell_state(cell)? == state)))
    }

    /// Adds a percept in a free cell.
    pub fn add(&mut self, place: Place, seen: &Surroundings) {
        if place.reach() >= FURTHEST {
            return;
        }
        shown(place, seen).for_each(|(cell, state)| self.sight(cell, state));
    }

    /// Returns the map with every cell state counted at most once.
    pub fn seen_once(mut self) -> Self {
        let counts = self.sightings.iter_mut().flatten();
        counts.for_each(|count| *count = (*count).min(1));
        self
    }

    /// Adds an observation of a cell. The state must not be `Hidden`.
    pub fn sight(&mut self, place: Place, state: CellState) {
        self.grow_to(place);
        let at = self.index(place).expect("the map has grown");
        let sightings = &mut self.sightings[at];
        if sightings.iter().sum::<u8>() >= MOST_SIGHTINGS {
            sightings.iter_mut().for_each(|count| *count /= 2);
        }
        sightings[state as usize] += 1;
    }

    fn grow_to(&mut self, place: Place) {
        if self.index(place).is_some() {
            return;
        }
        let old = std::mem::take(self);
        let size = |low: i16, high: i16| (high - low + 1) as u16;
        let (west, south, east, north) = match old.sightings.is_empty() {
            true => (place.east, place.north, place.east, place.north),
            false => {
                let far = old
                    .corner
                    .plus(Place::new(old.width as i16 - 1, old.height as i16 - 1));
                (
                    old.corner.east.min(place.east),
                    old.corner.north.min(place.north),
                    far.east.max(place.east),
                    far.north.max(place.north),
                )
            }
        };
        let (width, height) = (size(west, east), size(south, north));
        *self = Self {
            corner: Place::new(west, south),
            width,
            height,
            sightings: vec![[0; 3]; usize::from(width) * usize::from(height)],
        };
        for (place, sightings) in old.places().zip(&old.sightings) {
            let at = self.index(place).expect("the new map holds the old one");
            self.sightings[at] = *sightings;
        }
    }

    /// Returns all cells of the rectangle.
    pub fn places(&self) -> impl Iterator<Item = Place> + use<> {
        let (corner, width, height) = (self.corner, self.width as i16, self.height as i16);
        (0..height)
            .flat_map(move |row| (0..width).map(move |col| corner.plus(Place::new(col, row))))
    }

    /// Returns true if the map is valid.
    pub fn is_valid(&self) -> bool {
        let most = 2 * FURTHEST + 1;
        let inside = |place: Place| place.reach() <= FURTHEST;
        let far = (self.width.saturating_sub(1), self.height.saturating_sub(1));
        self.width <= most
            && self.height <= most
            && self.sightings.len() == usize::from(self.width) * usize::from(self.height)
            && inside(self.corner)
            && inside(self.corner.plus(Place::new(far.0 as i16, far.1 as i16)))
            && self.sightings.iter().all(|cell| {
                cell.iter().copied().map(u32::from).sum::<u32>() <= MOST_SIGHTINGS.into()
            })
    }
}
