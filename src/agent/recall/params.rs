//! Parameters and switches of `xcscr-memory`.

use super::map::MOST_CHARTS;
use xcs::settings;

settings! {
    section "memory";

    /// Settings of `xcscr-memory`. What it remembers is bounded: on each chart the cells that are at most
    /// 48 from the goal, the last 200 steps of the last 100 episodes, and 50,000 beliefs.
    pub struct MemoryParams {
        /// Is it learned how often cells are misread, and what is perceived weighed by that? If not,
        /// it is taken for right.
        doubts: bool = true;
        /// Charts at most: goals that can be told apart.
        charts: u32 = MOST_CHARTS as u32, in 1..=MOST_CHARTS as u32;
    }
}
