//! Parameters of the tabular rivals.

use xcs::settings;

settings! {
    section "tabular";

    /// Parameters of `q-learning`, `sarsa-lambda`, `dyna-q` and `r-max`. Rewards and the discount are
    /// those of all methods (`reward.*`).
    pub struct TabularParams {
        /// alpha: the learning rate of Q-learning, Sarsa and Dyna-Q. In a maze without chance, 1 is
        /// best.
        alpha: f64 = 1.0, in 1e-6..=1.0;
        /// lambda: the decay of Sarsa's eligibility traces.
        lambda: f64 = 0.9, in 0.0..=1.0;
        /// Remembered transitions that Dyna-Q replays after each step.
        replays: u32 = 50, in 0..=10_000;
        /// How often R-max must have tried a pair before it believes what it saw.
        known_after: u32 = 1, in 1..=1000;
        /// Does R-max's greedy policy follow its optimistic values, under which what is unknown is
        /// best? If not, it is planned on what is known.
        optimistic_policy: bool = true;
        /// Do R-max and Dyna-Q foretell collisions and ways back, as `xcscr-plus` does by default?
        foresight: bool = false;
        /// Does R-max remember as `xcscr-memory` does? It then draws the same charts (`memory.*`), believes and
        /// explores in the same way, and plans on beliefs, but its plan chooses, and no rules are learned. Where
        /// cells are misread and moves are exact, it plans on in each step for what it believes.
        /// `foresight` counts for nothing then: charts foresee by themselves. Dyna-Q has no such form and ignores this: it replays what percepts led to, and holds no belief.
        memory: bool = false;
    }
}
