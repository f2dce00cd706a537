//! Parameters of the tabular baselines.

use xcs::settings;

settings! {
    section "tabular";

    /// Parameters of `q-learning`, `sarsa-lambda` and `dyna-q`. Rewards and the discount are
    /// those of all methods (`reward.*`).
    pub struct TabularParams {
        /// alpha: the learning rate of Q-learning, Sarsa and Dyna-Q. In a deterministic maze, 1 is
        /// best.
        alpha: f64 = 1.0, in 1e-6..=1.0;
        /// lambda: the decay of Sarsa's eligibility traces.
        lambda: f64 = 0.9, in 0.0..=1.0;
        /// Remembered transitions that Dyna-Q replays after each step.
        replays: u32 = 50, in 0..=10_000;
    }
}
