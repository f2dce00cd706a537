//! What cells of a map pay by themselves, once in an episode.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::association::MapStep;
use crate::agent::estimator::map::cell_counts::FURTHEST;
use crate::agent::estimator::map::place::Place;

/// What coming into a cell paid, for the first time in an episode.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct CellReward {
    /// What it paid last.
    reward: f64,
    /// Episodes in which it paid, and in which it did not.
    counts: [u32; 2],
}

/// By place: what it paid. Only places that have paid are remembered.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RewardMap(BTreeMap<Place, CellReward>);

impl RewardMap {
    /// Takes down what an episode found, where its steps took place there, as far as is certain.
    pub fn add(&mut self, steps: &[MapStep], places: &[Option<Place>]) {
        let mut entered = BTreeSet::new();
        for (step, pair) in steps.iter().zip(places.windows(2)) {
            let Some(place) = pair[1].filter(|_| pair[0] != pair[1]) else {
                continue;
            };
            if entered.insert(place) {
                self.count(place, step.found);
            }
        }
    }

    fn count(&mut self, place: Place, found: f64) {
        if found > 0.0 {
            let payment = self.0.entry(place).or_default();
            payment.reward = found;
            payment.counts[0] = payment.counts[0].saturating_add(1);
        } else if let Some(payment) = self.0.get_mut(&place) {
            payment.counts[1] = payment.counts[1].saturating_add(1);
        }
    }

    /// The places that pay more often than not, with what they pay, the nearest to the goal first.
    pub fn likely(&self) -> Vec<(Place, f64)> {
        let paid = |payment: &CellReward| payment.counts[0] > payment.counts[1];
        let likely = self.0.iter().filter(|(_, payment)| paid(payment));
        let mut likely: Vec<_> = likely
            .map(|(place, payment)| (*place, payment.reward))
            .collect();
        likely.sort_by_key(|(place, _)| place.reach());
        likely
    }

    /// Can payments be like this?
    pub fn is_sound(&self) -> bool {
        let sound = |(place, payment): (&Place, &CellReward)| {
            place.reach() <= FURTHEST && payment.reward.is_finite() && payment.reward >= 0.0
        };
        self.0.iter().all(sound)
    }
}
