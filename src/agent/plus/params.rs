//! Parameters and switches of `xcscr-plus`.

use serde::{Deserialize, Serialize};

use xcs::bounds::{OutOfRange, within};

/// The repairs of `xcscr-plus`, each with its switch. Rewards, discount and the first
/// step-threshold are those of all methods (`reward.*`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlusParams {
    /// Is the cost of a step part of what is learned?
    pub step_cost: bool,
    /// Are rules updated toward one-step Bellman targets? If not, toward shares of the long-term
    /// reward along the executed path, which lock onto the first path found.
    pub bellman: bool,
    /// Remembered transitions that are replayed after each step, by frequency; 0 to 10,000.
    pub replays: u32,
    /// Are remembered transitions swept backward at the end of an episode until values settle?
    pub sweep: bool,
    /// Does exploration head for the least-tried actions? If not, it is random (p_explr).
    pub least_tried_first: bool,
    /// Is the loop-erased path of a success imprinted, where it returned more than expected?
    pub imprinting: bool,
    /// Does a collision lower its rules at once, toward a target that has a floor?
    pub short_term_target: bool,
    /// Does the step-threshold learn?
    pub learning_step_threshold: bool,
    /// The step-threshold shrinks toward this many times the length of a success; 1 to 100.
    pub slack: f64,
    /// Do general rules learned from bumps spare later ones?
    pub collision_rules: bool,
    /// Do bumps of one action tell about the others, turned?
    pub turned_rules: bool,
    /// Do general rules about ways back spare trying them in every cell?
    pub return_rules: bool,
    /// The power to which the forecast of a collision (a share of votes) is raised before it is
    /// believed; 1 to 1000. At 1, votes that are not yet sorted out send the robot on detours.
    pub certainty: u32,
    /// The learning rate toward targets that are means already; above 0, at most 1.
    pub beta: f64,
    /// P# of the rules of \[P\] while they are learned; they are condensed afterwards. 0 to 1.
    pub dont_care: f64,
}

impl Default for PlusParams {
    fn default() -> Self {
        Self {
            step_cost: true,
            bellman: true,
            replays: 5,
            sweep: true,
            least_tried_first: true,
            imprinting: true,
            short_term_target: true,
            learning_step_threshold: true,
            slack: 3.0,
            collision_rules: true,
            turned_rules: true,
            return_rules: true,
            certainty: 32,
            beta: 1.0,
            dont_care: 0.0,
        }
    }
}

impl PlusParams {
    /// Accepts the parameters when each lies in its range.
    ///
    /// # Errors
    /// The first parameter that does not.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("plus.replays", self.replays, 0..=10_000)?;
        within("plus.slack", self.slack, 1.0..=100.0)?;
        within("plus.certainty", self.certainty, 1..=1000)?;
        within("plus.beta", self.beta, 1e-6..=1.0)?;
        within("plus.dont_care", self.dont_care, 0.0..=1.0)
    }
}
