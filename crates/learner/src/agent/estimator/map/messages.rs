//! Where a robot may be at one step of an episode.

use crate::agent::estimator::map::cell_counts::FURTHEST;
use crate::agent::estimator::map::place::Place;

/// Likelihoods below this share of the greatest are dropped.
const NEGLIGIBLE: f64 = 1e-6;
/// A place in which the robot was at least so likely is where it was.
const CERTAIN: f64 = 0.6;
/// Cells on each side of a square that holds all places of a map.
const SIDE: usize = 2 * FURTHEST as usize + 1;

/// Likelihoods of places, in order; those of all others are zero.
pub struct Message {
    /// Each place with its likelihood.
    pub places: Vec<(Place, f64)>,
}

impl Message {
    /// A place that is the only one.
    pub fn only(place: Place) -> Self {
        let places = vec![(place, 1.0)];
        Self { places }
    }

    /// The likelihood of a place, if there is one.
    pub fn of(&self, place: Place) -> Option<f64> {
        let found = self.places.binary_search_by_key(&place, |one| one.0).ok()?;
        Some(self.places[found].1)
    }

    /// The same as shares that add up to 1.
    pub fn shares(&self) -> Self {
        let sum: f64 = self.places.iter().map(|one| one.1).sum();
        let shares = self.places.iter();
        let places = shares.map(|&(place, weight)| (place, weight / sum));
        Self {
            places: places.collect(),
        }
    }

    /// Where the robot was, if that is certain; the likelihoods add up to 1.
    pub fn certain(&self) -> Option<Place> {
        let likely = self.places.iter().find(|one| one.1 >= CERTAIN);
        likely.map(|one| one.0)
    }
}

/// Adds likelihoods by place.
pub struct Accumulator {
    sums: Vec<f64>,
    touched: Vec<Place>,
    /// What was added in all, and what of it to places beyond every map.
    added: f64,
    beyond: f64,
}

impl Accumulator {
    /// Nothing was added yet.
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

    /// Adds to the likelihood of a place. Of a place beyond every map only the sum is kept.
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

    /// Is most of what was added beyond every map?
    pub fn is_mostly_beyond(&self) -> bool {
        self.beyond > self.added / 2.0
    }

    /// Multiplies what was added to each place.
    pub fn weigh(&mut self, by: impl Fn(Place) -> f64) {
        for &place in &self.touched {
            self.sums[Self::at(place)] *= by(place);
        }
    }

    /// The sums, the greatest of them made 1, and what it was; begins anew.
    pub fn layer(&mut self) -> (Message, f64) {
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
