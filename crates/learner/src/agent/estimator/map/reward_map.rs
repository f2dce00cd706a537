//! Rewards of the cells of a map, each paid once per episode.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::cell_counts::FURTHEST;
use crate::agent::estimator::map::place::Place;
use crate::agent::estimator::map::robot_model::MapStep;

/// The reward for entering a cell for the first time in an episode.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct CellReward {
    /// The last reward paid.
    reward: f64,
    /// The numbers of episodes in which it was paid, and in which it was not.
    counts: [u32; 2],
}

/// By cell, the reward. Contains only cells that have paid.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RewardMap(BTreeMap<Place, CellReward>);

impl RewardMap {
    /// Adds the rewards of an episode. `places` holds the cell of each step, if it is certain.
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

    /// Returns the cells where a reward was found in most visits, with their rewards. The nearest to the
    /// goal come first.
    pub fn likely(&self) -> Vec<(Place, f64)> {
        let paid = |payment: &CellReward| payment.counts[0] > payment.counts[1];
        let likely = self.0.iter().filter(|(_, payment)| paid(payment));
        let mut likely: Vec<_> = likely
            .map(|(place, payment)| (*place, payment.reward))
            .collect();
        likely.sort_by_key(|(place, _)| place.reach());
        likely
    }

    /// Returns true if the rewards are valid.
    pub fn is_valid(&self) -> bool {
        let is_payment = |(place, payment): (&Place, &CellReward)| {
            place.reach() <= FURTHEST && payment.reward.is_finite() && payment.reward >= 0.0
        };
        self.0.iter().all(is_payment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::map::place::CellState;

    #[test]
    fn a_cell_that_is_entered_twice_in_an_episode_counts_once() {
        let [a, b] = [0, 1].map(|east| Place::new(east, 0));
        let step = |found| MapStep {
            found,
            ..MapStep::moved([CellState::Free; 8], 0)
        };
        let mut map = RewardMap::default();
        map.add(&[7.0, 0.0, 0.0].map(step), &[a, b, a, b].map(Some));
        assert_eq!(map.likely(), [(b, 7.0)]);
        map.add(&[step(0.0)], &[a, b].map(Some));
        assert!(
            map.likely().is_empty(),
            "control: paid in one of two visits"
        );
    }
}
