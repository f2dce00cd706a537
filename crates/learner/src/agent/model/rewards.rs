//! What is paid on the way to the goal, and what is best then.

use serde::{Deserialize, Serialize};

use crate::agent::model::pomdp::GOAL;

/// No way costs more steps than this.
pub const MOST_STEPS: f64 = 4000.0;
/// Discounts with which neither a sum of rewards is without end nor only the next one counts.
const DISCOUNTS: [f64; 2] = [0.01, 0.999_999];
/// What the goal is worth at least.
const LEAST_GOAL: f64 = 1e-6;

/// Rewards on the way. With them the best policy is no longer the one of the fewest steps, but the
/// one of the greatest discounted sum of all rewards, as the methods that learn values have it.
///
/// Sums are counted from that of walking for ever. So counted a step is worth nothing, a reward on
/// the way what it pays, and the goal what it pays and that the walking has an end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RewardModel {
    pub(super) discount: f64,
    /// What arriving at the goal is worth.
    goal: f64,
    /// By state: what was found in all to be in it. The difference is what a move pays.
    found: Vec<f64>,
}

impl RewardModel {
    /// With a discount per step, for a goal that pays `goal` where each step pays `step`; `found`
    /// tells what was found in all to be in a state.
    pub fn new(discount: f64, goal: f64, step: f64, found: Vec<f64>) -> Self {
        let discount = discount.clamp(DISCOUNTS[0], DISCOUNTS[1]);
        let goal = goal - discount * step / (1.0 - discount);
        Self {
            discount,
            goal: goal.max(LEAST_GOAL),
            found,
        }
    }

    /// What a move gains at once.
    pub(super) fn gain(&self, state: u32, next: u32) -> f64 {
        match next {
            GOAL => self.goal,
            _ => self.found[next as usize] - self.found[state as usize],
        }
    }

    /// The steps from the goal at which one is as well off, were there nothing but the goal: fewer
    /// than none, where there is more.
    pub(super) fn in_steps(&self, value: f64) -> f64 {
        let steps = 1.0 + libm::log(value / self.goal) / libm::log(self.discount);
        match value > 0.0 {
            true => steps.min(MOST_STEPS),
            false => MOST_STEPS,
        }
    }

    pub(super) fn is_sound(&self, states: usize) -> bool {
        (DISCOUNTS[0]..=DISCOUNTS[1]).contains(&self.discount)
            && self.goal.is_finite()
            && self.goal >= LEAST_GOAL
            && self.found.len() == states
            && self.found.iter().all(|found| found.is_finite())
    }
}
