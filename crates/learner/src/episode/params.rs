//! Exploration in episodes.

use xcs::settings;

settings! {
    section "episode";

    /// Settings of the episode loop.
    pub struct Params {
        /// p_explr: the probability that a step takes a random action. `xcscr-plus` and `r-max` ignore it unless
        /// `plus.planned_exploration` is false.
        explore: f64 = 0.3, in 0.0..=1.0;
        /// Alternate, as in Wilson's experiments with XCS: an episode with random actions and the
        /// GA, then a greedy episode without the GA. Both learn. `explore` has no effect then.
        alternate: bool = false;
    }
}

impl Params {
    /// Returns `Some(true)` if episode `number` (from 1) only explores, `Some(false)` if it only
    /// exploits, and `None` if it does both.
    pub fn turn_of(&self, number: u32) -> Option<bool> {
        self.alternate.then_some(number % 2 == 1)
    }
}
