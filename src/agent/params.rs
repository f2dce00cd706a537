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

/// What `xcs` and `xcsam` are paid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum XcsPayment {
    /// Each step its short-term reward, the last one of a success also the long-term reward of
    /// `reward.goal`: the paper's section II-C says that standard XCS "encapsulates long-term
    /// rewards into short-term rewards".
    All,
    /// Nothing but the long-term reward, Eq. 7 after a success and `reward.failure` after a
    /// failure: the paper introduces short-term rewards that reach rules as what is new in XCSCR
    /// (section III-A), and Wilson (1995) and Butz pay mazes in this way.
    Final,
}

/// What `xcs` and `xcsam` make of an episode that ends at the step limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepLimitUpdate {
    /// A failure: the last \[A\] is updated, and nothing follows it (paper, section II-C: r_l
    /// equals zero if the task fails).
    Failure,
    /// Nothing: the last \[A\] is not updated (XCSF).
    Dropped,
}

/// When the GA runs in the action sets that wait in \[R\].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StackEvolution {
    /// After the episode, each set right after its update; the GA's clock stands still meanwhile,
    /// so that a rule that is in several of the sets takes part only once.
    AfterCredit,
    /// In the step in which the set was formed (figure 1: the GA lies inside the iteration loop),
    /// before the set is credited.
    EachStep,
}

/// Rewards, and the parameters and switches of the reward methods.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Params {
    /// r_l for reaching a goal (paper, section II-C); 0 to 1,000,000.
    pub goal: f64,
    /// r_l for a failure (paper, section II-C: 0, but figures 2 and 5 show worths below 0, and the
    /// text speaks of long-term, negative rewards); -1,000,000 to 0.
    pub failure: f64,
    /// What `xcs` and `xcsam` are paid.
    pub xcs_payment: XcsPayment,
    /// What `xcs` and `xcsam` make of the step limit.
    pub xcs_step_limit: StepLimitUpdate,
    /// When the GA runs in methods with a reward stack.
    pub stack_evolution: StackEvolution,
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
    /// beta of the short-term filter after a collision; above 0, at most 1. The paper calls
    /// collisions punishments (section III-A) and learns punishments with 0.05 (section III-C);
    /// 0.2 is the rate of everything else.
    pub beta_collision: f64,
    /// beta of Eq. 10, with which the step-threshold moves toward a success; above 0, at most 1.
    /// 0.2 is the rate after a success.
    pub beta_step_threshold: f64,
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
            failure: 0.0,
            xcs_payment: XcsPayment::All,
            xcs_step_limit: StepLimitUpdate::Failure,
            stack_evolution: StackEvolution::AfterCredit,
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
            beta_collision: 0.2,
            beta_step_threshold: 0.2,
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
        within("reward.failure", self.failure, -1e6..=0.0)?;
        within("reward.step", self.step, -1e6..=0.0)?;
        within("reward.collision", self.collision, -1e6..=0.0)?;
        within("reward.gamma", self.gamma, 0.0..=1.0)?;
        within("reward.even_constant", self.even_constant, 0.0..=1e6)?;
        within("reward.step_threshold", self.step_threshold, 1..=1_000_000)?;
        within("reward.theta_rs", self.theta_rs, -1e6..=0.0)?;
        within("reward.theta_x", self.theta_x, 0.0..=1.0)?;
        within("reward.beta_success", self.beta_success, 1e-6..=1.0)?;
        within("reward.beta_failure", self.beta_failure, 1e-6..=1.0)?;
        within("reward.beta_collision", self.beta_collision, 1e-6..=1.0)?;
        within(
            "reward.beta_step_threshold",
            self.beta_step_threshold,
            1e-6..=1.0,
        )
    }

    /// The same without the four mechanisms of XCSCR: XCS adapted to robots (Williams et al.), one
    /// reward at the end, of which every \[A\] of the episode gets its share (Eq. 7 with 8 or 9).
    pub(super) fn adapted(self, sharing: Sharing) -> Self {
        Self {
            sharing,
            short_term_filter: false,
            imprinting: false,
            learning_rate_switching: false,
            learning_step_threshold: false,
            ..self
        }
    }

    /// r_s: what an outcome is worth at once.
    pub fn short_term(&self, outcome: Outcome) -> f64 {
        match outcome {
            Outcome::Collided { .. } => self.collision,
            Outcome::Moved | Outcome::Stalled | Outcome::ReachedGoal => self.step,
        }
    }

    /// r_l of an episode of `steps` steps: `goal + 1/time` for a success (Eq. 7, time in steps),
    /// `failure` for a failure.
    pub fn long_term(&self, reached_goal: bool, steps: usize) -> f64 {
        if reached_goal {
            self.goal + 1.0 / steps.max(1) as f64
        } else {
            self.failure
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
