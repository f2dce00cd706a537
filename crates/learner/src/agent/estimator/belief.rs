//! Beliefs: probability distributions over states.

use serde::{Deserialize, Serialize};

use crate::agent::model::pomdp::{GOAL, Pomdp};
use xcs::Action;
use xcscr_robot::world::each_other;

/// States less likely than this are dropped.
pub const NEGLIGIBLE_PROBABILITY: f64 = 1e-4;

/// States in ascending order with their probabilities, which sum to 1. Empty if nothing is known.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Belief(Vec<(u32, f64)>);

/// A possible result of an action.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// The probability of this result.
    pub probability: f64,
    /// The number of the resulting percept.
    pub look: u32,
    /// The belief after this percept.
    pub belief: Belief,
}

impl Belief {
    /// The uniform belief over some states, given in ascending order.
    pub fn even(states: impl IntoIterator<Item = u32>) -> Self {
        Self(states.into_iter().map(|state| (state, 1.0)).collect()).normalised()
    }

    /// The states with their probabilities.
    pub fn states(&self) -> &[(u32, f64)] {
        &self.0
    }

    /// Returns true if the belief contains no state.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the most likely state with its probability; the first one if several are equal.
    pub fn likeliest(&self) -> Option<(u32, f64)> {
        let better = |best: (u32, f64), one: (u32, f64)| if one.1 > best.1 { one } else { best };
        self.0.iter().copied().reduce(better)
    }

    /// Returns the results of an action by percept. The goal is left out: nothing is perceived there.
    pub fn branches(&self, pomdp: &Pomdp, action: Action) -> Vec<Branch> {
        let mut reached = Vec::with_capacity(self.0.len() * 2);
        self.each_move(pomdp, action, |_, next, weight| {
            if next != GOAL && weight > 0.0 {
                reached.push((pomdp.look(next), next, weight));
            }
        });
        reached.sort_unstable_by_key(|&(look, state, _)| (look, state));
        reached
            .chunk_by(|a, b| a.0 == b.0)
            .map(|same_percept| Branch {
                probability: same_percept.iter().map(|one| one.2).sum(),
                look: same_percept[0].0,
                belief: Self::merged(same_percept).normalised(),
            })
            .collect()
    }

    /// Visits every state and successor with their joint probability.
    fn each_move(&self, pomdp: &Pomdp, action: Action, mut visit: impl FnMut(u32, u32, f64)) {
        let each = each_other(pomdp.slip(), pomdp.actions());
        for &(state, weight) in &self.0 {
            visit(
                state,
                pomdp.next(state, action),
                weight * (1.0 - pomdp.slip()),
            );
            if each > 0.0 {
                let others = Action::all(pomdp.actions()).filter(|&other| other != action);
                others
                    .for_each(|executed| visit(state, pomdp.next(state, executed), weight * each));
            }
        }
    }

    /// Returns the belief after an action. Only moves that are `possible`, from one state to another, count.
    /// Empty if none is.
    pub fn after(
        &self,
        pomdp: &Pomdp,
        action: Action,
        possible: impl Fn(u32, u32) -> bool,
    ) -> Self {
        let mut reached = Vec::with_capacity(self.0.len());
        self.each_move(pomdp, action, |state, next, weight| {
            if next != GOAL && weight > 0.0 && possible(state, next) {
                reached.push((0, next, weight));
            }
        });
        // In state order, so that sums are the same on every machine.
        reached.sort_by_key(|&(_, state, _)| state);
        Self::merged(&reached).normalised()
    }

    /// Returns the belief after a percept that fits each of `states` states with likelihood `fits`. With
    /// probability `mislocalised`, or if `expected` is empty, every state is possible.
    pub fn weighed(
        expected: &Self,
        mislocalised: f64,
        states: u32,
        fits: impl Fn(u32) -> f64,
    ) -> Self {
        let mislocalised = if expected.is_empty() {
            1.0
        } else {
            mislocalised
        };
        let mut expected = expected.0.iter().copied().peekable();
        let weighed = (0..states).map(|state| {
            let here = expected.next_if(|one| one.0 == state);
            let here = here.map_or(0.0, |one| one.1 * (1.0 - mislocalised));
            let weight = here + mislocalised / f64::from(states);
            (state, weight * fits(state))
        });
        Self(weighed.collect()).normalised()
    }

    /// Returns the expected immediate cost of an action.
    pub fn cost_of_acting(&self, pomdp: &Pomdp, action: Action) -> f64 {
        let mut cost = pomdp.cost_of_step();
        if pomdp.rewards().is_none() {
            return cost;
        }
        self.each_move(pomdp, action, |state, next, weight| {
            cost += weight * pomdp.cost_of_move(state, next);
        });
        cost
    }

    fn merged(same_percept: &[(u32, u32, f64)]) -> Self {
        let mut states: Vec<(u32, f64)> = Vec::with_capacity(same_percept.len());
        for &(_, state, weight) in same_percept {
            match states.last_mut() {
                Some((last, sum)) if *last == state => *sum += weight,
                _ => states.push((state, weight)),
            }
        }
        Self(states)
    }

    fn normalised(mut self) -> Self {
        let sum: f64 = self.0.iter().map(|one| one.1).sum();
        self.0.retain(|one| one.1 > NEGLIGIBLE_PROBABILITY * sum);
        let sum: f64 = self.0.iter().map(|one| one.1).sum();
        self.0.iter_mut().for_each(|one| one.1 /= sum);
        self
    }

    /// Returns a hash of the states and their probabilities. The probabilities are quantised to sixteen
    /// levels, relative to the most likely state.
    pub fn key(&self) -> u64 {
        let greatest = self.likeliest().map_or(1.0, |one| one.1);
        let mut key = 0xcbf2_9ce4_8422_2325_u64;
        for &(state, weight) in &self.0 {
            let level = (weight / greatest * 16.0).round() as u64;
            if level > 0 {
                // The finaliser of SplitMix64: two beliefs in 2^64 collide by chance.
                key = (key ^ (u64::from(state) << 5 | level)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                key ^= key >> 29;
                key = key.wrapping_mul(0xbf58_476d_1ce4_e5b9);
                key ^= key >> 32;
            }
        }
        key
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beliefs_share_a_key_if_their_weights_agree_in_sixteen_levels_and_only_then() {
        let belief = |weight| Belief(vec![(0, 1.0 - weight), (1, weight)]);
        assert_eq!(belief(0.300).key(), belief(0.301).key());
        assert_ne!(belief(0.30), belief(0.301), "they are not the same");
        assert_ne!(belief(0.30).key(), belief(0.36).key());
    }
}
