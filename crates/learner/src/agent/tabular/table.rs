//! The table of values Q.

use std::collections::BTreeMap;

use crate::agent::knowledge::Knowledge;
use crate::agent::model::transitions::Experience;
use xcs::PredictionArray;
use xcs::{Action, ByAction, Percept};

/// Q: the value of each action in each percept met; 0 if nothing was learned.
#[derive(Debug, Clone)]
pub(super) struct Table {
    actions: usize,
    /// The values by percept and action.
    rows: BTreeMap<Percept, ByAction<f64>>,
}

impl Table {
    pub fn new(actions: usize) -> Self {
        Self {
            actions,
            rows: BTreeMap::new(),
        }
    }

    /// Returns the number of pairs of a percept met and an action.
    pub fn len(&self) -> usize {
        self.rows.len() * self.actions
    }

    /// Returns Q of a pair.
    pub fn get(&self, percept: &Percept, action: Action) -> f64 {
        self.rows
            .get(percept)
            .map_or(0.0, |row| row[action.index()])
    }

    /// Returns a mutable reference to Q of a pair.
    pub fn entry(&mut self, percept: Percept, action: Action) -> &mut f64 {
        &mut self.rows.entry(percept).or_default()[action.index()]
    }

    /// Returns the greatest Q of a percept; 0 at a goal.
    pub fn greatest(&self, percept: Option<&Percept>) -> f64 {
        let row = percept.and_then(|percept| self.rows.get(percept));
        row.map_or(0.0, |row| {
            row[..self.actions].iter().copied().fold(f64::MIN, f64::max)
        })
    }

    /// Returns Q of all actions in a percept.
    pub fn values(&self, percept: &Percept) -> PredictionArray {
        let mut array = PredictionArray::new(self.actions);
        Action::all(self.actions).for_each(|action| array.set(action, self.get(percept, action)));
        array
    }

    /// Returns the whole table.
    pub fn knowledge(&self) -> Knowledge {
        let rows = self.rows.iter().map(|(percept, row)| {
            (
                *percept,
                row[..self.actions].iter().copied().map(Some).collect(),
            )
        });
        Knowledge::Table(rows.collect())
    }

    /// Performs one Q-learning update: toward the reward plus the discounted greatest next value.
    pub fn q_update(&mut self, transition: &Experience, alpha: f64, gamma: f64) {
        let target = transition.reward + gamma * self.greatest(transition.next.as_ref());
        let q = self.entry(transition.percept, transition.action);
        *q += alpha * (target - *q);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_q_update_moves_toward_the_reward_and_the_discounted_best_value() {
        let [here, there]: [Percept; 2] = ["00", "01"].map(|bits| bits.parse().unwrap());
        let action = Action::new(1).unwrap();
        let mut table = Table::new(2);
        *table.entry(there, action) = 100.0;
        let step = |next| Experience {
            percept: here,
            action,
            reward: -1.0,
            next,
        };
        table.q_update(&step(Some(there)), 0.5, 0.9);
        assert_eq!(table.get(&here, action), 44.5); // 0 + 0.5 (-1 + 0.9 * 100 - 0)
        table.q_update(&step(None), 1.0, 0.9);
        assert_eq!(table.get(&here, action), -1.0);
    }
}
