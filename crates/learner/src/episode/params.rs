//! How episodes explore.

use xcs::settings;

settings! {
    section "episode";

    /// Settings of the episode loop.
    pub struct Params {
        /// p_explr: the probability that a step explores, taking a random action.
        explore: f64 = 0.3, in 0.0..=1.0;
        /// Take turns, as in Wilson's experiments with XCS: an episode in which every action is
        /// random and the GA runs, then one that is greedy and in which it rests. Both learn.
        /// `explore` has no meaning then.
        alternate: bool = false;
    }
}

impl Params {
    /// Does episode `number` (from 1) only explore (`Some(true)`), only exploit (`Some(false)`),
    /// or mix both?
    pub fn turn_of(&self, number: u32) -> Option<bool> {
        self.alternate.then_some(number % 2 == 1)
    }
}
