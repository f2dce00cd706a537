//! All reward parameters, with their defaults in one place.

use serde::{Deserialize, Serialize};

use xcs::bounds::OutOfRange;
use xcs::settings;
use xcscr_robot::arena::Outcome;

/// How the long-term reward is shared out among the steps of an episode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sharing {
    /// The same share for every step (Eq. 8).
    Even,
    /// A smaller share for each step further from the end (Eq. 9).
    Discounted,
}

/// The rewards of `xcs` and `xcsam`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum XcsPayment {
    /// The short-term reward at each step, and the long-term reward `reward.goal` at the last step
    /// of a success. The paper's section II-C says that standard XCS "encapsulates long-term
    /// rewards into short-term rewards".
    All,
    /// Only the long-term reward: Eq. 7 after a success, `reward.failure` after a failure. The
    /// paper introduces short-term rewards that reach rules as new in XCSCR (section III-A). Wilson
    /// (1995) and Butz reward mazes in this way.
    Final,
}

/// The update of `xcs` and `xcsam` when an episode ends at the step limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepLimitUpdate {
    /// A failure: the last \[A\] is updated without a successor (paper, section II-C: r_l equals
    /// zero if the task fails).
    Failure,
    /// No update of the last \[A\] (XCSF).
    Dropped,
}

/// When the GA runs in the action sets of \[R\].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StackEvolution {
    /// After the episode, in each set right after its update. The GA's clock stands still
    /// meanwhile, so that a rule that is in several of the sets takes part only once.
    AfterCredit,
    /// In the step in which the set was formed (figure 1: the GA is inside the iteration loop),
    /// before the set is credited.
    EachStep,
}

settings! {
    section "reward";

    /// Rewards, and the parameters and switches of the reward methods.
    pub struct Params {
        /// r_l, the long-term reward for reaching a goal (paper, section II-C).
        goal: f64 = 1000.0, in 0.0..=1e6;
        /// r_l, the long-term reward for a failure. The paper gives 0 (section II-C), but figures 2 and 5 show values
        /// below 0, and the text mentions negative long-term rewards.
        failure: f64 = 0.0, in -1e6..=0.0;
        /// Rewards of `xcs` and `xcsam`. `all`: the reward of each step, and that of the goal at the
        /// end. `final`: only the reward at the end.
        xcs_payment: XcsPayment = XcsPayment::All;
        /// What `xcs` and `xcsam` learn at the step limit. `failure`: the last \[A\] is updated
        /// without a successor. `dropped`: the last \[A\] is not updated.
        xcs_step_limit: StepLimitUpdate = StepLimitUpdate::Failure;
        /// When the GA runs in methods with a reward stack. `after-credit`: after the episode.
        /// `each-step`: in each step, before its reward is known.
        stack_evolution: StackEvolution = StackEvolution::AfterCredit;
        /// r_s, the short-term reward of a step without a collision (paper, section II-C).
        step: f64 = -1.0, in -1e6..=0.0;
        /// r_s, the short-term reward of a step that ends in a collision (paper, section II-C).
        collision: f64 = -50.0, in -1e6..=0.0;
        /// gamma: the discount per step. With 0.71, the payoffs of neighbouring cells twelve steps from the goal
        /// differ by less than 10. With such an epsilon_0, rules that match both look accurate.
        gamma: f64 = 0.9, in 0.0..=1.0;
        /// c of Eq. 8, in steps. 0 means the length of the shortest success of the trial so far: then the best path
        /// gets the whole reward in each step.
        even_constant: f64 = 0.0, in 0.0..=1e6;
        /// The initial step limit: the maximum number of steps of an episode. The paper calls it the
        /// step-threshold and does not print its value.
        step_threshold: u32 = 50, in 1..=1_000_000;
        /// Raise the step limit to four times the shortest path from the farthest start if
        /// `step_threshold` is lower. Setting `step_threshold` turns this off.
        step_threshold_from_maze: bool = true;
        /// How the reward of an episode is shared among its steps, where the mechanisms act. `even`: equally.
        /// `discounted`: less for steps further from the end.
        sharing: Sharing = Sharing::Discounted;
        /// theta_rs: the short-term filter applies to rewards up to this value (Alg. 1).
        theta_rs: f64 = -50.0, in -1e6..=0.0;
        /// theta_x: imprinting follows a failure with probability 1 - theta_x (Alg. 2, as printed).
        theta_x: f64 = 0.5, in 0.0..=1.0;
        /// beta after a success (paper, section III-C), and of Eq. 10, with which the step limit moves toward the length
        /// of a success.
        beta_success: f64 = 0.2, in 1e-6..=1.0;
        /// beta after a failure (paper, section III-C).
        beta_failure: f64 = 0.05, in 1e-6..=1.0;
        /// beta of the short-term filter after a collision. The paper calls collisions punishments
        /// (section III-A) and learns punishments with 0.05 (section III-C). The paper learns
        /// everything else with 0.2.
        beta_collision: f64 = 0.2, in 1e-6..=1.0;
        /// Enable the short-term reward filter (`xcscr`, `xcscr-coevolved` and `xcscr-plus`).
        short_term_filter: bool = true;
        /// Enable imprinting after failures (`xcscr`, `xcscr-coevolved` and `xcscr-plus`).
        imprinting: bool = true;
        /// Store policies for imprinting without their loops: the steps between two visits to a cell are dropped.
        loop_erasure: bool = true;
        /// Enable learning-rate switching (`xcscr`, `xcscr-coevolved` and `xcscr-plus`). Without it, all updates use
        /// `xcs.beta`.
        learning_rate_switching: bool = true;
        /// Enable learning of the step limit (`xcscr`, `xcscr-coevolved` and `xcscr-plus`). In a world without a start cell, the limit is not learned,
        /// because a success from a near start says nothing about a far one.
        learning_step_threshold: bool = true;
    }
}

impl Params {
    /// Returns the parameters without the four mechanisms of XCSCR: XCS adapted to robots (Williams
    /// et al.). One reward at the end is shared among all \[A\] of the episode (Eq. 7 with 8 or 9).
    pub(in crate::agent) fn adapted(self, sharing: Sharing) -> Self {
        Self {
            sharing,
            short_term_filter: false,
            imprinting: false,
            learning_rate_switching: false,
            learning_step_threshold: false,
            ..self
        }
    }

    /// Checks that a collision fires the short-term filter, if the filter is on and collisions cost anything.
    ///
    /// # Errors
    /// `reward.collision` is between `reward.theta_rs` and 0.
    pub(crate) fn check_filter(&self) -> Result<(), OutOfRange> {
        let ignored = self.theta_rs < self.collision && self.collision < 0.0;
        match self.short_term_filter && ignored {
            true => Err(OutOfRange {
                key: "reward.collision",
                value: self.collision.to_string(),
                allowed: format!(
                    "0 or at most `reward.theta_rs` ({}), or the short-term filter ignores it; set `reward.theta_rs`, \
                     too, or `reward.short_term_filter=false`",
                    self.theta_rs
                ),
            }),
            false => Ok(()),
        }
    }

    /// Returns r_s: the immediate reward of an outcome.
    pub fn short_term(&self, outcome: Outcome) -> f64 {
        match outcome {
            Outcome::Collided { .. } => self.collision,
            Outcome::Moved | Outcome::Stalled | Outcome::ReachedGoal => self.step,
        }
    }

    /// Returns r_l of an episode of `steps` steps: `goal + 1/time` for a success (Eq. 7, time in
    /// steps), `failure` for a failure.
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
            params.short_term(Outcome::Collided { impulse_n_s: None }),
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
