//! The marginal likelihood of observations, summed over the possible states of the cells.

use std::collections::BTreeMap;

use crate::agent::estimator::map::cell_counts::{CellCounts, FURTHEST};
use crate::agent::estimator::map::place::{CellState, Place, shown};
use crate::agent::estimator::map::robot_model::MapStep;

/// The prior probabilities of a cell's states: free, wall, goal.
const FIRST: [f64; 3] = [0.49, 0.49, 0.02];

/// By cell, the number of observations of each state: free, wall, goal.
#[derive(Debug, Clone, Default)]
pub struct Observations(BTreeMap<Place, [u32; 3]>);

impl Observations {
    /// Collects the observations of an episode through these cells. Its goal is perceived as `goal`.
    pub fn of(steps: &[MapStep], places: &[Option<Place>], goal: CellState) -> Self {
        let mut seen = Self::default();
        seen.sight(Place::ORIGIN, goal);
        for (step, place) in steps.iter().zip(places) {
            let Some(place) = place.filter(|place| place.reach() < FURTHEST) else {
                continue;
            };
            shown(place, &step.around).for_each(|(cell, state)| seen.sight(cell, state));
        }
        seen
    }

    /// Collects the observations of a map.
    pub fn of_map(cell_map: &CellCounts) -> Self {
        Self(
            cell_map
                .seen()
                .map(|(place, seen)| (place, seen.map(u32::from)))
                .collect(),
        )
    }

    fn sight(&mut self, place: Place, state: CellState) {
        self.0.entry(place).or_default()[state as usize] += 1;
    }

    /// Returns the number of observed cells.
    pub fn cells(&self) -> usize {
        self.0.len()
    }

    /// Adds other observations.
    pub fn add(&mut self, others: &Self) {
        self.change(others, |own, count| own + count);
    }

    /// Removes observations that were added before.
    pub fn remove(&mut self, others: &Self) {
        self.change(others, |own, count| own - count);
    }

    fn change(&mut self, others: &Self, changed: impl Fn(u32, u32) -> u32) {
        for (place, counts) in &others.0 {
            let own = self.0.entry(*place).or_default();
            *own = std::array::from_fn(|state| changed(own[state], counts[state]));
        }
    }

    /// Returns the log2 likelihood of the observations.
    pub fn bits(&self, observation_error: f64) -> f64 {
        let likelihood = CellLikelihood::of(observation_error);
        self.0.values().map(|counts| likelihood.bits(counts)).sum()
    }

    /// Returns the log2 likelihood of other observations, given these.
    pub fn bits_of(&self, others: &Self, observation_error: f64) -> f64 {
        let likelihood = CellLikelihood::of(observation_error);
        let gain = |(place, counts): (&Place, &[u32; 3])| match self.0.get(place) {
            Some(own) => {
                let both = std::array::from_fn(|state| own[state] + counts[state]);
                likelihood.bits(&both) - likelihood.bits(own)
            }
            None => likelihood.bits(counts),
        };
        others.0.iter().map(gain).sum()
    }
}

/// The log2 likelihoods of one cell's states and observations.
struct CellLikelihood {
    first: [f64; 3],
    right: f64,
    wrong: f64,
}

impl CellLikelihood {
    /// Creates the likelihoods. Both wrong states are equally likely.
    fn of(observation_error: f64) -> Self {
        Self {
            first: FIRST.map(libm::log2),
            right: libm::log2(1.0 - observation_error),
            wrong: libm::log2(observation_error / 2.0),
        }
    }

    /// Returns the log2 likelihood of a cell's observations.
    fn bits(&self, counts: &[u32; 3]) -> f64 {
        let all: u32 = counts.iter().sum();
        let each: [f64; 3] = std::array::from_fn(|state| {
            let agreeing = counts[state];
            self.first[state]
                + f64::from(agreeing) * self.right
                + f64::from(all - agreeing) * self.wrong
        });
        let most = each.into_iter().fold(f64::NEG_INFINITY, f64::max);
        most + libm::log2(each.iter().map(|bits| libm::exp2(bits - most)).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OBSERVATION_ERROR: f64 = 0.03;

    /// The percept in the cell south of the goal, between walls, with `observation_error` wrong cells.
    fn seen(observation_error: usize) -> Observations {
        let mut around = [CellState::Wall; 8];
        around[0] = CellState::Goal;
        (1..=observation_error).for_each(|at| around[at] = CellState::Free);
        let step = MapStep::moved(around, 0);
        Observations::of(&[step], &[Some(Place::new(0, -1))], CellState::Goal)
    }

    #[test]
    fn one_wrong_cell_fits_the_map_better_than_an_empty_one_and_many_do_not() {
        let mut cell_map = Observations::default();
        (0..3).for_each(|_| cell_map.add(&seen(0)));
        let gain = |observation_error| {
            let seen = seen(observation_error);
            cell_map.bits_of(&seen, OBSERVATION_ERROR) - seen.bits(OBSERVATION_ERROR)
        };
        assert!(gain(0) > gain(1) && gain(1) > 0.0);
        assert!(gain(5) < 0.0, "control");
    }

    #[test]
    fn removing_what_was_added_restores_the_likelihood() {
        let mut cell_map = seen(0);
        let before = cell_map.bits(OBSERVATION_ERROR);
        cell_map.add(&seen(2));
        let more = cell_map.bits(OBSERVATION_ERROR);
        assert!(more < before, "control");
        cell_map.remove(&seen(2));
        assert_eq!(cell_map.bits(OBSERVATION_ERROR), before);
    }

    #[test]
    fn the_likelihood_of_episodes_is_the_same_one_by_one_and_together() {
        let mut cell_map = seen(0);
        let one_by_one =
            cell_map.bits(OBSERVATION_ERROR) + cell_map.bits_of(&seen(1), OBSERVATION_ERROR);
        cell_map.add(&seen(1));
        assert!((cell_map.bits(OBSERVATION_ERROR) - one_by_one).abs() < 1e-9);
    }
}
