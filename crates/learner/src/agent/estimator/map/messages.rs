//! Forward and backward messages: likelihoods of the robot's cell at one step of an episode.

use crate::agent::estimator::map::cell_counts::FURTHEST;
use crate::agent::estimator::map::place::Place;

/// Likelihoods below this share of the greatest one are dropped.
const NEGLIGIBLE: f64 = 1e-6;
/// The minimum probability at which the robot's cell counts as certain.
const CERTAIN: f64 = 0.6;
/// The side of a square that contains all cells of a map, in cells.
const SIDE: usize = 2 * FURTHEST as usize + 1;

/// Likelihoods of cells, in ascending order of the cells; all others are zero.
pub struct Message {
    /// Each cell with its likelihood.
    pub places: Vec<(Place, f64)>,
}

impl Message {
    /// The message with a single cell.
    pub fn only(place: Place) -> Self {
        let places = vec![(place, 1.0)];
        Self { places }
    }

    /// Returns the likelihood of a cell, if the message contains it.
    pub fn of(&self, place: Place) -> Option<f64> {
        let found = self.places.binary_search_by_key(&place, |one| one.0).ok()?;
        Some(self.places[found].1)
    }

    /// Returns the message normalised to sum 1.
    pub fn shares(&self) -> Self {
        let sum: f64 = self.places.iter().map(|one| one.1).sum();
        let shares = self.places.iter();
        let places = shares.map(|&(place, weight)| (place, weight / sum));
        Self {
            places: places.collect(),
        }
    }

    /// Returns the robot's cell if it is certain. The likelihoods must sum to 1.
    pub fn certain(&self) -> Option<Place> {
        let likely = self.places.iter().find(|one| one.1 >= CERTAIN);
        likely.map(|one| one.0)
    }
}

/// Sums likelihoods by cell.
pub struct Accumulator {
    sums: Vec<f64>,
    touched: Vec<Place>,
    /// The sum of all added weights, and its part for cells outside every map.
    added: f64,
    beyond: f64,
}

impl Accumulator {
    /// Creates an empty accumulator.
    pub fn new() -> Self {
        Self {
            sums: vec![0.0; SIDE * SIDE],
            touched: Vec::new(),
            added: 0.0,
            beyond: 0.0,
        }
    }

    fn at(place: Place) -> usize {
        let along = |cells: i16| (cells + FURTHEST as i16) as usize;
        along(place.north) * SIDE + along(place.east)
    }

    /// Adds to the likelihood of a cell. For cells outside every map only the sum is recorded.
    pub fn add(&mut self, place: Place, weight: f64) {
        if weight <= 0.0 {
            return;
        }
        self.added += weight;
        if place.reach() > FURTHEST {
            self.beyond += weight;
            return;
        }
        let sum = &mut self.sums[Self::at(place)];
        if *sum == 0.0 {
            self.touched.push(place);
        }
        *sum += weight;
    }

    /// Returns true if most of the added weight is outside every map.
    pub fn is_mostly_beyond(&self) -> bool {
        self.beyond > self.added / 2.0
    }

    /// Multiplies the sum of each cell.
    pub fn weigh(&mut self, by: impl Fn(Place) -> f64) {
        for &place in &self.touched {
            self.sums[Self::at(place)] *= by(place);
        }
    }

    /// Returns the sums, scaled to a maximum of 1, and the maximum before scaling. Resets the
    /// accumulator.
    pub fn take_message(&mut self) -> (Message, f64) {
        (self.added, self.beyond) = (0.0, 0.0);
        let mut touched = std::mem::take(&mut self.touched);
        touched.sort_unstable();
        let sum = |sums: &[f64], place: &Place| sums[Self::at(*place)];
        let greatest = touched
            .iter()
            .map(|place| sum(&self.sums, place))
            .fold(0.0, f64::max);
        let mut places = Vec::with_capacity(touched.len());
        for place in touched {
            let weight = std::mem::take(&mut self.sums[Self::at(place)]);
            if weight > NEGLIGIBLE * greatest {
                places.push((place, weight / greatest));
            }
        }
        (Message { places }, greatest)
    }
}
