//! Parameters of the tabular rivals.

use serde::{Deserialize, Serialize};

use xcs::bounds::{OutOfRange, within};

/// Parameters of `q-learning`, `sarsa-lambda`, `dyna-q` and `r-max`. Rewards and the discount are
/// those of all methods (`reward.*`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TabularParams {
    /// alpha: the learning rate of Q-learning, Sarsa and Dyna-Q; above 0, at most 1. In a maze
    /// without chance, 1 is best.
    pub alpha: f64,
    /// lambda: the decay of Sarsa's eligibility traces; 0 to 1.
    pub lambda: f64,
    /// Remembered transitions that Dyna-Q replays after each step; 0 to 10,000.
    pub replays: u32,
    /// How often R-max must have tried a pair before it believes what it saw; 1 to 1000.
    pub known_after: u32,
    /// Does R-max's greedy policy follow its optimistic values, under which what is unknown is
    /// best? If not, it is planned on what is known.
    pub optimistic_policy: bool,
}

impl Default for TabularParams {
    fn default() -> Self {
        Self {
            alpha: 1.0,
            lambda: 0.9,
            replays: 50,
            known_after: 1,
            optimistic_policy: true,
        }
    }
}

impl TabularParams {
    /// Accepts the parameters when each lies in its range.
    ///
    /// # Errors
    /// The first parameter that does not.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("tabular.alpha", self.alpha, 1e-6..=1.0)?;
        within("tabular.lambda", self.lambda, 0.0..=1.0)?;
        within("tabular.replays", self.replays, 0..=10_000)?;
        within("tabular.known_after", self.known_after, 1..=1000)
    }
}
