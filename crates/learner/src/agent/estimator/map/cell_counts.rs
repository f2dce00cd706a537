//! A map: what was seen around one goal, cell by cell.

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::place::{CellState, NEIGHBOURS, Place, Surroundings, Vision};

/// Observations of a cell that count; from here on the older ones fade.
const MOST_SIGHTINGS: u8 = 20;
/// Cells further from the goal than this, in moves, are not mapped.
pub const FURTHEST: u16 = 64;
/// The weight of whatever is seen in a cell that nobody has seen before, beside that of a cell that agrees with the map. This is
/// no probability: a new cell counts nearly as much as one that agrees, so that maps grow.
const UNKNOWN: f64 = 0.9;
/// The same of a percept in a place of which nothing is known: the place and the eight cells around it.
pub const UNSEEN: f64 = 0.387_420_489;
/// If cells are misread no more often than this, what was seen otherwise was mostly seen elsewhere, where the robot was
/// taken for being here.
const RARE: f64 = 0.002;
/// The sightings that every state is granted in advance.
const PRIOR: f64 = 0.003;

/// Observations of each state, for the cells of a rectangle that grows.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct CellCounts {
    /// The most western and southern cell.
    corner: Place,
    width: u16,
    height: u16,
    sightings: Vec<[u8; 3]>,
}

impl CellCounts {
    /// The sightings of a cell: free, wall, goal.
    fn sightings(&self, place: Place) -> [u8; 3] {
        self.index(place).map_or([0; 3], |at| self.sightings[at])
    }

    fn index(&self, place: Place) -> Option<usize> {
        let Place { east, north } = place.minus(self.corner);
        let (col, row) = (u16::try_from(east).ok()?, u16::try_from(north).ok()?);
        let inside = col < self.width && row < self.height;
        inside.then_some(usize::from(row) * usize::from(self.width) + usize::from(col))
    }

    /// What was seen most often in a cell; `None` if nothing was.
    pub fn cell_state(&self, place: Place) -> Option<CellState> {
        let [free, wall, goal] = self.sightings(place);
        match free.max(wall).max(goal) {
            0 => None,
            most if most == free => Some(CellState::Free),
            most if most == wall => Some(CellState::Wall),
            _ => Some(CellState::Goal),
        }
    }

    /// The cells that were seen, and how often each state was: free, wall, goal.
    pub fn seen(&self) -> impl Iterator<Item = (Place, [u8; 3])> + '_ {
        let cells = self.places().zip(self.sightings.iter().copied());
        cells.filter(|(_, seen)| *seen != [0; 3])
    }

    /// How many cells were seen.
    pub fn cells(&self) -> usize {
        let seen = |sightings: &&[u8; 3]| sightings.iter().any(|count| *count > 0);
        self.sightings.iter().filter(seen).count()
    }

    /// What would be seen in a place; `None` if some of it is not mapped.
    pub fn around(&self, place: Place, vision: Vision) -> Option<Surroundings> {
        vision.seen(NEIGHBOURS.map(|by| self.cell_state(place.plus(by))))
    }

    /// How likely it is to perceive this in a place, when a state is misread with probability
    /// `misread`.
    pub fn likelihood(&self, place: Place, seen: &Surroundings, observation_error: f64) -> f64 {
        let here = self.state_likelihood(place, CellState::Free, observation_error);
        let cells = NEIGHBOURS.iter().zip(seen);
        cells.fold(here, |product, (&by, &state)| {
            product * self.state_likelihood(place.plus(by), state, observation_error)
        })
    }

    fn state_likelihood(&self, place: Place, state: CellState, observation_error: f64) -> f64 {
        if state == CellState::Hidden {
            // The walls that hide it are weighed themselves.
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
        // What the cell may be, by the theorem of Bayes; another state is read with half of `misread`.
        let odds = (observation_error / 2.0) / (1.0 - observation_error);
        let seen: u8 = sightings.iter().sum();
        let truly = sightings.map(|count| (count..seen).fold(1.0, |share, _| share * odds));
        let share = truly[state as usize] / truly.iter().sum::<f64>();
        (1.0 - observation_error) * share + observation_error / 2.0 * (1.0 - share)
    }

    /// The mapped cells around a place, and whether they are seen as they were mapped.
    pub fn compare(
        &self,
        place: Place,
        seen: &Surroundings,
    ) -> impl Iterator<Item = (Place, bool)> {
        let cells = NEIGHBOURS.into_iter().zip(*seen);
        let cells = cells.filter(|(_, state)| *state != CellState::Hidden);
        let cells = cells.map(move |(by, state)| (place.plus(by), state));
        cells.filter_map(|(cell, state)| Some((cell, self.cell_state(cell)? == state)))
    }

    /// Takes down what is seen in a place, which is free.
    pub fn add(&mut self, place: Place, seen: &Surroundings) {
        if place.reach() >= FURTHEST {
            return;
        }
        self.sight(place, CellState::Free);
        let cells = NEIGHBOURS.iter().zip(seen);
        for (&by, &state) in cells.filter(|(_, state)| **state != CellState::Hidden) {
            self.sight(place.plus(by), state);
        }
    }

    /// The same map as if every cell had been seen but once.
    pub fn seen_once(mut self) -> Self {
        let counts = self.sightings.iter_mut().flatten();
        counts.for_each(|count| *count = (*count).min(1));
        self
    }

    /// Takes down what a cell is; it must be seen.
    pub fn sight(&mut self, place: Place, state: CellState) {
        self.grow_to(place);
        let at = self.index(place).expect("the cell_map has grown");
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
            let at = self
                .index(place)
                .expect("the new cell_map holds the old one");
            self.sightings[at] = *sightings;
        }
    }

    /// All cells of the rectangle.
    pub fn places(&self) -> impl Iterator<Item = Place> + use<> {
        let (corner, width, height) = (self.corner, self.width as i16, self.height as i16);
        (0..height)
            .flat_map(move |row| (0..width).map(move |col| corner.plus(Place::new(col, row))))
    }

    /// Can a map look like this?
    pub fn is_sound(&self) -> bool {
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
