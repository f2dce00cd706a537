//! Auxiliary rewards and their effect on the optimal policy.

use serde::{Deserialize, Serialize};

use crate::agent::model::pomdp::GOAL;

/// The maximum length of a path in steps.
pub const MOST_STEPS: f64 = 4000.0;
/// The range of discounts: sums of rewards are finite, and later rewards count.
const DISCOUNTS: [f64; 2] = [0.01, 0.999_999];
/// The least value of the goal.
const LEAST_GOAL: f64 = 1e-6;

/// Auxiliary rewards. With them, the optimal policy maximises the discounted sum of all rewards, as in
/// value-based methods, and not the number of steps.
///
/// Values are relative to walking forever. Relative to that, a step has the value 0, and an auxiliary
/// reward its amount. The goal has its reward plus the saved cost of all further steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RewardModel {
    pub(super) discount: f64,
    /// The value of arriving at the goal.
    goal: f64,
    /// By state: the sum of collected rewards. The difference between two states is the reward of the
    /// move.
    found: Vec<f64>,
}

impl RewardModel {
    /// Creates the model from the discount per step and the rewards of the goal and of a step. `found` is
    /// the sum of the rewards collected in each state.
    pub fn new(discount: f64, goal: f64, step: f64, found: Vec<f64>) -> Self {
        let discount = discount.clamp(DISCOUNTS[0], DISCOUNTS[1]);
        let goal = goal - discount * step / (1.0 - discount);
        Self {
            discount,
            goal: goal.max(LEAST_GOAL),
            found,
        }
    }

    /// Returns the immediate gain of a move.
    pub(super) fn gain(&self, state: u32, next: u32) -> f64 {
        match next {
            GOAL => self.goal,
            _ => self.found[next as usize] - self.found[state as usize],
        }
    }

    /// Converts a value to the equivalent number of steps from the goal without auxiliary rewards. The
    /// result is negative for greater values.
    pub(super) fn in_steps(&self, value: f64) -> f64 {
        let steps = 1.0 + libm::log(value / self.goal) / libm::log(self.discount);
        match value > 0.0 {
            true => steps.min(MOST_STEPS),
            false => MOST_STEPS,
        }
    }

    pub(super) fn is_valid(&self, states: usize) -> bool {
        (DISCOUNTS[0]..=DISCOUNTS[1]).contains(&self.discount)
            && self.goal.is_finite()
            && self.goal >= LEAST_GOAL
            && self.found.len() == states
            && self.found.iter().all(|found| found.is_finite())
    }
}
