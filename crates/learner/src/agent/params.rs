//! All reward numbers, with their defaults in one place.

use serde::{Deserialize, Serialize};

use xcs::settings;
use xcscr_robot::arena::Outcome;

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

settings! {
    section "reward";

    /// Rewards, and the parameters and switches of the reward methods.
    pub struct Params {
        /// r_l for reaching a goal (paper, section II-C).
        goal: f64 = 1000.0, in 0.0..=1e6;
        /// r_l for a failure (paper, section II-C: 0, but figures 2 and 5 show values below 0, and
        /// the text speaks of long-term, negative rewards).
        failure: f64 = 0.0, in -1e6..=0.0;
        /// What `xcs` and `xcsam` are paid.
        xcs_payment: XcsPayment = XcsPayment::All;
        /// What `xcs` and `xcsam` make of the step limit.
        xcs_step_limit: StepLimitUpdate = StepLimitUpdate::Failure;
        /// When the GA runs in methods with a reward stack.
        stack_evolution: StackEvolution = StackEvolution::AfterCredit;
        /// r_s of a step (paper, section II-C).
        step: f64 = -1.0, in -1e6..=0.0;
        /// r_s of a step that ends in a collision (paper, section II-C).
        collision: f64 = -50.0, in -1e6..=0.0;
        /// gamma: the discount per step. At 0.71, twelve steps from the goal, the payoffs of
        /// neighbouring cells differ by less than epsilon_0, and rules that mix them look accurate.
        gamma: f64 = 0.9, in 0.0..=1.0;
        /// c of Eq. 8, in steps. At 0 it is the length of the shortest success so far in the trial,
        /// so that the best path is paid in full.
        even_constant: f64 = 0.0, in 0.0..=1e6;
        /// The step-threshold at first: the most steps of an episode. The paper does not print its
        /// own.
        step_threshold: u32 = 50, in 1..=1_000_000;
        /// Is the step-threshold raised to four times the longest shortest path of the maze, where
        /// `step_threshold` is less? Setting `step_threshold` turns this off.
        step_threshold_from_maze: bool = true;
        /// How `xcscr` shares out the long-term reward.
        sharing: Sharing = Sharing::Discounted;
        /// theta_rs: the short-term filter answers rewards up to this (Alg. 1).
        theta_rs: f64 = -50.0, in -1e6..=0.0;
        /// theta_x: imprinting follows a failure with probability 1 - theta_x (Alg. 2, as printed).
        theta_x: f64 = 0.5, in 0.0..=1.0;
        /// beta after a success (paper, section III-C).
        beta_success: f64 = 0.2, in 1e-6..=1.0;
        /// beta after a failure (paper, section III-C).
        beta_failure: f64 = 0.05, in 1e-6..=1.0;
        /// beta of the short-term filter after a collision. The paper calls collisions punishments
        /// (section III-A) and learns punishments with 0.05 (section III-C); 0.2 is the rate of
        /// everything else.
        beta_collision: f64 = 0.2, in 1e-6..=1.0;
        /// beta of Eq. 10, with which the step-threshold moves toward a success. 0.2 is the rate
        /// after a success.
        beta_step_threshold: f64 = 0.2, in 1e-6..=1.0;
        /// Does `xcscr` use the short-term reward filter?
        short_term_filter: bool = true;
        /// Does `xcscr` imprint?
        imprinting: bool = true;
        /// Does `xcscr` switch the learning rate? If not, it learns with `xcs.beta` throughout.
        learning_rate_switching: bool = true;
        /// Does `xcscr` learn the step-threshold?
        learning_step_threshold: bool = true;
    }
}

impl Params {
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

    /// r_s: what an outcome is worth at once, with the auxiliary reward that was found.
    pub fn short_term(&self, outcome: Outcome) -> f64 {
        match outcome {
            Outcome::Collided { .. } => self.collision,
            Outcome::FoundReward { reward } => self.step + reward,
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
        let found = Outcome::FoundReward { reward: 7.0 };
        assert_eq!(params.short_term(found), 6.0);
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
