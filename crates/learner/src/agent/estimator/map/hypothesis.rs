//! A map hypothesis: a map and statistics of the episodes on it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::association::Alignment;
use crate::agent::estimator::map::cell_counts::CellCounts;
use crate::agent::estimator::map::place::{CellState, Place};
use crate::agent::estimator::map::reward_map::RewardMap;
use crate::agent::estimator::map::robot_model::MapStep;

/// The number of steps stored per episode, counted from its end.
pub const KEPT_STEPS: usize = 2000;
/// Episodes have a fixed start if at least this many began there, and at least the share `ALWAYS`.
const LEAST_BEGUN: u32 = 3;
const ALWAYS: f64 = 0.9;

/// A map, the rewards of its cells, the number of its episodes, and where they began.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct MapHypothesis {
    pub cell_map: CellCounts,
    pub payments: RewardMap,
    pub episodes: f64,
    /// The number of episodes that began in each cell.
    begun: BTreeMap<Place, u32>,
    /// The number of the transferred map from which this hypothesis was created.
    pub transferred: Option<u8>,
}

impl MapHypothesis {
    /// Creates transferred map number `number` with only a goal, which is perceived as `goal`.
    pub fn transferred(number: u8, goal: CellState) -> Self {
        let mut hypothesis = Self {
            episodes: 1.0,
            transferred: Some(number),
            ..Self::default()
        };
        hypothesis.cell_map.sight(Place::ORIGIN, goal);
        hypothesis
    }

    /// Adds an aligned episode.
    pub fn add(&mut self, steps: &[MapStep], alignment: &Alignment) {
        self.episodes += 1.0;
        for (step, place) in steps.iter().zip(&alignment.places) {
            place
                .iter()
                .for_each(|&place| self.cell_map.add(place, &step.around));
        }
        self.payments.add(steps, &alignment.places);
        // The first steps of longer episodes are not stored.
        let whole = steps.len() < KEPT_STEPS;
        let begun = alignment.places.first().copied().flatten();
        if let Some(place) = begun.filter(|_| whole) {
            let count = self.begun.entry(place).or_default();
            *count = count.saturating_add(1);
        }
    }

    /// Records that all episodes begin in this cell, as in the world the map was transferred from.
    pub fn always_begins_in(&mut self, place: Place) {
        self.begun.insert(place, LEAST_BEGUN);
    }
}

/// Returns the map and the cell in which episodes always begin, if there is one.
pub fn always_in<'a>(hypotheses: impl Iterator<Item = &'a MapHypothesis>) -> Option<(u8, Place)> {
    let begun = hypotheses.enumerate().flat_map(|(cell_map, hypothesis)| {
        let places = hypothesis.begun.iter();
        places.map(move |(place, count)| (*count, (cell_map as u8, *place)))
    });
    let begun: Vec<(u32, (u8, Place))> = begun.collect();
    let all: f64 = begun.iter().map(|(count, _)| f64::from(*count)).sum();
    let (most, place) = begun.into_iter().max()?;
    (most >= LEAST_BEGUN && f64::from(most) >= ALWAYS * all).then_some(place)
}
