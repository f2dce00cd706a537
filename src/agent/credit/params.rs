//! All reward numbers, with their defaults in one place.

use serde::{Deserialize, Serialize};

use crate::arena::Outcome;
use xcs::bounds::{OutOfRange, within};

/// How the long-term reward is shared out among the steps of an episode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sharing {
    /// Every step the same (Eq. 8).
    Even,
    /// Less for each step further from the end (Eq. 9).
    Discounted,
}

/// Rewards, and the parameters and switches of the reward methods.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Params {
    /// r_l for reaching a goal (paper, section II-C); 0 to 1,000,000.
    pub goal: f64,
    /// r_s of a step (paper, section II-C); -1,000,000 to 0.
    pub step: f64,
    /// r_s of a step that ends in a collision (paper, section II-C); -1,000,000 to 0.
    pub collision: f64,
    /// gamma: the discount per step; 0 to 1. At 0.71, twelve steps from the goal, the payoffs of
    /// neighbouring cells differ by less than epsilon_0, and rules that mix them look accurate.
    pub gamma: f64,
    /// c of Eq. 8, in steps; 0 to 1,000,000. At 0 it is the length of the shortest success so far
    /// in the trial, so that the best path is paid in full.
    pub even_constant: f64,
    /// The step-threshold at first: the most steps of an episode; 1 to 1,000,000. The paper does
    /// not print its own.
    pub step_threshold: u32,
    /// Is the step-threshold raised to four times the longest shortest path of the maze, where
    /// `step_threshold` is less? Setting `step_threshold` turns this off; so do files written
    /// before it existed.
    #[serde(default)]
    pub step_threshold_from_maze: bool,
    /// How `xcscr` shares out the long-term reward.
    pub sharing: Sharing,
    /// theta_rs: the short-term filter answers rewards up to this (Alg. 1); -1,000,000 to 0.
    pub theta_rs: f64,
    /// theta_x: imprinting follows a failure with probability 1 - theta_x (Alg. 2, as printed);
    /// 0 to 1.
    pub theta_x: f64,
    /// beta after a success (paper, section III-C); above 0, at most 1.
    pub beta_success: f64,
    /// beta after a failure (paper, section III-C); above 0, at most 1.
    pub beta_failure: f64,
    /// Does `xcscr` use the short-term reward filter?
    pub short_term_filter: bool,
    /// Does `xcscr` imprint?
    pub imprinting: bool,
    /// Does `xcscr` switch the learning rate? If not, it learns with `xcs.beta` throughout.
    pub learning_rate_switching: bool,
    /// Does `xcscr` learn the step-threshold?
    pub learning_step_threshold: bool,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            goal: 1000.0,
            step: -1.0,
            collision: -50.0,
            gamma: 0.9,
            even_constant: 0.0,
            step_threshold: 50,
            step_threshold_from_maze: true,
            sharing: Sharing::Discounted,
            theta_rs: -50.0,
            theta_x: 0.5,
            beta_success: 0.2,
            beta_failure: 0.05,
            short_term_filter: true,
            imprinting: true,
            learning_rate_switching: true,
            learning_step_threshold: true,
        }
    }
}

impl Params {
    /// Accepts the parameters when each lies in its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("reward.goal", self.goal, 0.0..=1e6)?;
        within("reward.step", self.step, -1e6..=0.0)?;
        within("reward.collision", self.collision, -1e6..=0.0)?;
        within("reward.gamma", self.gamma, 0.0..=1.0)?;
        within("reward.even_constant", self.even_constant, 0.0..=1e6)?;
        within("reward.step_threshold", self.step_threshold, 1..=1_000_000)?;
        within("reward.theta_rs", self.theta_rs, -1e6..=0.0)?;
        within("reward.theta_x", self.theta_x, 0.0..=1.0)?;
        within("reward.beta_success", self.beta_success, 1e-6..=1.0)?;
        within("reward.beta_failure", self.beta_failure, 1e-6..=1.0)
    }

    /// r_s: what an outcome is worth at once.
    pub fn short_term(&self, outcome: Outcome) -> f64 {
        match outcome {
            Outcome::Collided { .. } => self.collision,
            Outcome::Moved | Outcome::Stalled | Outcome::ReachedGoal => self.step,
        }
    }

    /// r_l of an episode of `steps` steps: `goal + 1/time` for a success (Eq. 7, time in steps),
    /// 0 for a failure.
    pub fn long_term(&self, reached_goal: bool, steps: usize) -> f64 {
        if reached_goal {
            self.goal + 1.0 / steps.max(1) as f64
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equation_7_adds_one_over_the_time() {
        let params = Params::default();
        assert_eq!(params.long_term(true, 10), 1000.1);
        assert_eq!(params.long_term(false, 10), 0.0);
    }

    #[test]
    fn a_collision_costs_fifty_and_a_step_one() {
        let params = Params::default();
        assert_eq!(
            params.short_term(Outcome::Collided { impulse_ns: None }),
            -50.0
        );
        assert_eq!(params.short_term(Outcome::Moved), -1.0);
    }

    #[test]
    fn a_refused_value_is_named_with_its_range() {
        let params = Params {
            gamma: 1.5,
            ..Params::default()
        };
        assert_eq!(
            params.check().unwrap_err().to_string(),
            "`reward.gamma` is 1.5, but must be from 0 to 1"
        );
        Params::default().check().unwrap();
    }
}
